within Friction;
model TanhRegularised "Coulomb friction smoothed at v = 0; it holds nothing at rest, so the spool creeps"
  //   |f| = F_Coulomb tanh(|v|/v_0)
  extends Law;
  parameter Units.Force    F_Coulomb    "Coulomb friction";
  parameter Units.Velocity v_0   = 1e-3 "Speed at which 76 % of it acts";
equation
  f_slide = F_Coulomb*tanh(speed/v_0);
  f_static = 0;
end TanhRegularised;
