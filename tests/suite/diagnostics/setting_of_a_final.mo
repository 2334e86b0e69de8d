// status: 2
// error[MO0209] --set:1:16
// args: --set body.mass=2
model Body
  parameter Real mass = 1;
  Real v(start = 1);
equation
  mass*der(v) = -v;
end Body;
model Two
  Body body(final mass = 3);
end Two;
