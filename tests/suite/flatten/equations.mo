//@ case wrong_type
model Switch
  Boolean on;
  Real x(start = 0);
equation
  //@ error[MO1220] 3-8
  on = 1;
  //@ error[MO0212] 15-16
  der(x) = if x then 1 else 2;
end Switch;

//@ case size_mismatch
model Sums
  Real a[3] = {1, 2, 3};
  Real b[2];
equation
  //@ error[MO0215] 3-7
  b = a;
end Sums;
