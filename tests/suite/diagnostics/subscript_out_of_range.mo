// status: 1
// error[MO0216] 5:14
model Sums
  Real a[3] = {1, 2, 3};
  Real b = a[4];
end Sums;
