within Friction;
model Coulomb "Dry friction, independent of speed, pressure and time"
  extends Law;
  parameter Units.Force F_Coulomb "Coulomb friction";
equation
  f_slide = F_Coulomb;
  f_static = F_Coulomb;
end Coulomb;
