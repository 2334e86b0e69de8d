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

//@ case values_that_stand_alone
model Room
  Real T(start = 290, fixed = true);
  Real x[2] = {T, 2*T};
equation
  der(T) = 300 - T;
  //@ error[MO1293] 3-8
  der(T);
  //@ error[MO1293] 3-8
  sum(x);
  //@ error[MO1293] 3-14
  sample(0, 1);
end Room;
