// status: 1
// error[MO0226] 6:42
// error[MO0216] 11:18
// error[MO0216] 13:18
model Enumerations
  type Size = enumeration(small, medium, small);
  type Gear = enumeration(low, high);
  parameter Real ratio[Gear] = {3, 1};
  parameter Boolean on = true;
  Real flags[Boolean] = {0, 1};
  Real x = ratio[1];
  Real y = flags[on];
  Real z = flags[2];
  Real w = ratio[Gear.low];
  Size size = Size.medium;
end Enumerations;
