// status: 3
// error[MO0912] 8:3
// The assertion comes before the equation that has no solution for this parameter.
model Root
  parameter Real p = -4;
  Real x(start = 1);
equation
  assert(p >= 0, "p must not be negative");
  x^2 = p;
end Root;
