// status: 2
// error[MO0241] -
// args: --set v=2
model Body
  parameter Real mass = 1;
  Real v(start = 1);
equation
  mass*der(v) = -v;
end Body;
