//@ case initial_profile_that_changes
// What a line begins with is known before the model runs.
model Pipe
  Real x(start = 0, fixed = true);
  Real y, z;
equation
  der(x) = 1;
  //@ error[MO0321] 12-64
  (y, z) = spatialDistribution(time, 0, x, true, {0, 1}, {x, 2});
end Pipe;
