within Friction;
model TanhRegularised "Dry friction smoothed at v = 0; holds nothing at rest, so the spool creeps"
  extends Law;
  parameter Units.Force    F_Coulomb    "Coulomb friction";
  parameter Units.Velocity v_0   = 1e-3 "Speed at which 76 % of it acts";
equation
  f_slide = F_Coulomb*tanh(speed/v_0);
  f_static = 0;
end TanhRegularised;
