// status: 3
// error[MO0912] 9:3
// What an initial section asserts is checked at the start, when initialisation has found the values.
model Filled
  Real p(start = 1);
initial equation
  p^2 = 2;
initial algorithm
  assert(p > 2, "the volume begins with " + String(p, significantDigits = 4) + " bar");
equation
  der(p) = -p;
end Filled;
