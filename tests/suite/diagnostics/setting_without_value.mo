// status: 2
// error[MO0240] -
// args: --set mass
model Body
  parameter Real mass = 1;
  Real v(start = 1);
equation
  mass*der(v) = -v;
end Body;
