//@ case components_and_their_connections
model Optional
  parameter Boolean damped = true;
  Translational.Mass mass(m = 1, s_start = 1);
  Translational.Spring spring(c = 4);
  Translational.Damper damper(d = 4) if damped;
  Translational.Fixed wall;
equation
  connect(wall.flange, spring.flange_a);
  connect(spring.flange_b, mass.flange);
  connect(wall.flange, damper.flange_a);
  connect(damper.flange_b, mass.flange);
  annotation(experiment(StopTime = 1, Tolerance = 1e-9));
end Optional;
// Critical damping with 2 rad/s.
//@ run
//@ expect mass.s = 3*exp(-2) rel 1e-7
//@ run set=damped=false
//@ expect mass.s = cos(2) rel 1e-7
//@ expect no column damper.f
