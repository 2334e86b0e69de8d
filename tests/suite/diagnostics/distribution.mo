// status: 1
// error[MO0219] 13:53
// error[MO0219] 14:47
// error[MO0219] 15:18
// error[MO0212] 16:18
// error[MO0219] 17:57
// What `spatialDistribution` may be given.
model Pipe
  Real x(start = 0, fixed = true), y[10];
  parameter Real p = 0.5;
equation
  der(x) = 1;
  (y[1], y[2]) = spatialDistribution(x, 0, x, true, {0, 0.7, 0.5, 1}, {0, 0, 0, 0});
  (y[3], y[4]) = spatialDistribution(time, 0, p, true);
  (y[5], y[6]) = spatialDistribution(time, 0, x);
  (y[7], y[8]) = spatialDistribution(time, 0, x, 1);
  (y[9], y[10]) = spatialDistribution(time, 0, x, true, {0, 1}, {1, 2, 3});
end Pipe;
