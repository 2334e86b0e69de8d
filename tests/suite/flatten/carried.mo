// What is carried along a line, there and back, and a delay that changes.
model Carried
  Real x(start = 0, fixed = true) "how far everything has moved";
  Real v = 0.4*cos(time);
  Real left = 10 + time;
  Real right = -time;
  Real at_left;
  Real at_right;
  Real T = 0.5 + 0.25*sin(2*time);
  Real step = if time < 1 then 0 else 1 + time;
  Real late = delay(step, T, 1);
  Real slow = delay(sin(5*time), T, 1);
equation
  der(x) = v;
  (at_left, at_right) = spatialDistribution(left, right, x, v >= 0, {0, 0.5, 0.5, 1}, {0, 1, 3, 4});
end Carried;
