// status: 3
// error[MO0902] 8:3
// args: --set m=0
model Body
  parameter Real m = 1;
  Real v(start = 1, fixed = true);
equation
  der(v) = -v/m;
end Body;
