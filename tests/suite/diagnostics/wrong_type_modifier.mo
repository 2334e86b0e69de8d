// status: 1
// error[MO0212] 5:25
// error[MO0212] 6:30
model Switch
  parameter Integer n = 2.5;
  parameter Boolean closed = 1;
  Real x = n;
end Switch;
