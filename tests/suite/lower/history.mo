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
