// status: 1
// error[MO0200] 6:3
model Fall
  Real h(start = 1, fixed = true);
equation
  der(der(h)) = -9.81;
end Fall;
