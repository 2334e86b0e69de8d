//@ case closed_air_spring
//@ run stop=0.5 tolerance=1e-9
// Isothermal: p V stays, and at rest the piston bears the load.
model Rest
  Translational.Mass   body(m = 0.03);
  Pneumatics.AirSpring spring(p_supply = 3e5, C = 0, V_dead = 1e-6, A = 2e-4, s_empty = -5e-3);
  Effects.ViscousDrag  drag(d = 20);
  Translational.Force  load(f = -60);
equation
  connect(spring.flange, body.flange);
  connect(drag.flange, body.flange);
  connect(load.flange, body.flange);
end Rest;
//@ let volume = 1e-6 + 2e-4*5e-3
//@ let pressure = 1e5 + 60/2e-4
//@ expect body.s = (3e5*volume/pressure - volume)/2e-4 rel 1e-6
