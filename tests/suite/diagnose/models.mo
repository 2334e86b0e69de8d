//@ case swing
//@ used by diagnose.rs
model Swing
  parameter Real c = 80 "Stiffness";
  parameter Real d = 1.5 "Damping";
  parameter Real s_0 = 0.1 "Deflection at the start";
  Translational.Mass   mass(m = 1, s_start = s_0);
  Translational.Spring spring(c = c);
  Translational.Damper damper(d = d);
  Translational.Fixed  wall;
equation
  connect(wall.flange, spring.flange_a);
  connect(wall.flange, damper.flange_a);
  connect(spring.flange_b, mass.flange);
  connect(damper.flange_b, mass.flange);
  annotation(experiment(StopTime = 2, Tolerance = 1e-8));
end Swing;

//@ case cubic_spring
//@ used by diagnose.rs
within;
model Cubic "Spring that hardens"
  parameter Real k = 0 "Force per cube of the deflection";
  Translational.Flange flange;
equation
  flange.f = k*flange.s^3;
  annotation(__mocc(effect = "amplitude=k", explains = "The spring at %at hardens."));
end Cubic;
