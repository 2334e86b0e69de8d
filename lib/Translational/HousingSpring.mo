within Translational;
model HousingSpring "Linear spring with preload between a flange and the housing"
  extends PartialActuator;
  parameter Units.SpringStiffness c       "Stiffness";
  parameter Units.Force           f_0 = 0 "Preload: pull towards -s at s_0";
  parameter Units.Position        s_0 = 0 "Position at which it pulls with the preload";

  Fixed  housing(s_0 = s_0);
  Spring spring(c = c, f_0 = f_0);
equation
  connect(housing.flange, spring.flange_a);
  connect(spring.flange_b, flange);
end HousingSpring;
