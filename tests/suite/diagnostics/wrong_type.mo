// status: 1
// error[MO0212] 8:3
// error[MO0212] 9:15
model Switch
  Boolean on;
  Real x(start = 0);
equation
  on = 1;
  der(x) = if x then 1 else 2;
end Switch;
