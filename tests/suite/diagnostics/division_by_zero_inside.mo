// args: --stop 1.5 --interval 0.5 --method radau
// status: 3
// error[MO0902] 10:3
model Gap
  parameter Real d_0 = 0;
  Real s(start = 1, fixed = true);
  Real f;
equation
  der(s) = -1;
  f = 1 + 3/(d_0 + max(s, 0));
end Gap;
