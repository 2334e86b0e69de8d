// status: 1
// error[MO0274] 7:18
// error[MO0274] 8:34
// error[MO0274] 8:43
// Attributes are as constant as parameters.
model Changing
  Real x(start = x);
  Real y(fixed = true, nominal = x, min = time);
  Real z(start = p);
  parameter Real p = 2;
equation
  der(x) = -1;
  der(y) = x;
  der(z) = x;
end Changing;
