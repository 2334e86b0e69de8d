//@ case subscript_out_of_range
model Sums
  Real a[3] = {1, 2, 3};
  //@ error[MO0216] 14
  Real b = a[4];
end Sums;

//@ case enumerations_misused
model Enumerations
  //@ error[MO0226] 42-46
  type Size = enumeration(small, medium, small);
  type Gear = enumeration(low, high);
  parameter Real ratio[Gear] = {3, 1};
  parameter Boolean on = true;
  Real flags[Boolean] = {0, 1};
  //@ error[MO0216] 18
  Real x = ratio[1];
  Real y = flags[on];
  //@ error[MO0216] 18
  Real z = flags[2];
  Real w = ratio[Gear.low];
  Size size = Size.medium;
end Enumerations;

//@ case size_of_something_missing
// A size that hangs on something missing is not a second error.
model Sizes
  //@ error[MO0202] 29-32
  parameter Real given[:] = rows(3);
  //@ error[MO0202] 15-21
  Real y[:] = missing + given;
  Real z[size(y, 1)] = y;
end Sizes;
