//@ case initial_profile_that_changes
// The initial profile of a line must be known before the simulation.
model Pipe
  Real x(start = 0, fixed = true);
  Real y, z;
equation
  der(x) = 1;
  //@ error[MO0321] 12-64
  (y, z) = spatialDistribution(time, 0, x, true, {0, 1}, {x, 2});
end Pipe;

//@ case transport_filled_by_initialization
//@ run stop=1 tolerance=1e-8
// What a line holds at the start is a parameter that initialization determines. It leaves the line
// until 0.5 s, when what has entered since the start arrives.
model Pipe
  parameter Real T0(fixed = false);
  Real x;
  Real in1 = 10*time;
  Real out;
  Real back;
  Real sum(start = 0, fixed = true);
initial equation
  T0 = 3 + time;
equation
  x = 2*time;
  (back, out) = spatialDistribution(in1, 0, x, true, {0, 1}, {T0, T0});
  der(sum) = out;
end Pipe;
//@ expect out at 0.25 = 3 abs 1e-6
//@ expect out = 10*(1 - 0.5) abs 1e-6
// Half a second of 3, then a ramp from 0 to 5 within half a second.
//@ expect sum = 0.5*3 + 0.5*5/2 abs 1e-5
