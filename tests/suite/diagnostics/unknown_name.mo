// status: 1
// error[MO0202] 7:17
model Motion
  parameter Real friction = 0.1;
  Real speed(start = 1, fixed = true);
equation
  der(speed) = -fricton*speed;
end Motion;
