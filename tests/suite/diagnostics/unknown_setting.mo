// status: 2
// error[MO0241] -
// args: --set mas=2
model Body
  parameter Real mass = 1;
  Real v(start = 1);
equation
  mass*der(v) = -v;
end Body;
