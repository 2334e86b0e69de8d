// What was, some time ago: of a smooth course, of a jump, and around a loop.
model Delays
  parameter Real T = 0.3;
  Real x(start = 1, fixed = true);
  Real late = delay(sin(time), T);
  Real step = if time < 1 then 0 else 2;
  Real later = delay(step, T);
  Real sum(start = 0, fixed = true);
equation
  // x' = -x(t - 1) with x = 1 before: by the method of steps 1 - t, and then t^2/2 - 2 t + 3/2.
  der(x) = -delay(x, 1.0);
  der(sum) = later;
end Delays;
