// status: 1
// error[MO0202] 6:29
// error[MO0202] 7:15
// A size that hangs on something missing is not a second error.
model Sizes
  parameter Real given[:] = rows(3);
  Real y[:] = missing + given;
  Real z[size(y, 1)] = y;
end Sizes;
