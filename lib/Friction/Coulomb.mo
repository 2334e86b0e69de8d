within Friction;
model Coulomb "Coulomb friction, independent of speed, pressure and time"
  //   |f| = F_Coulomb while sliding,   |f| <= F_Coulomb at rest
  extends Law;
  parameter Units.Force F_Coulomb "Coulomb friction";
equation
  f_slide = F_Coulomb;
  f_static = F_Coulomb;
end Coulomb;
