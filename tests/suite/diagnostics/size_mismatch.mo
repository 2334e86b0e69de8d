// status: 1
// error[MO0215] 7:3
model Sums
  Real a[3] = {1, 2, 3};
  Real b[2];
equation
  b = a;
end Sums;
