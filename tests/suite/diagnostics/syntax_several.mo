// status: 1
// error[MO0004] 6:23
// error[MO0007] 8:14
// error[MO0005] 9:5
model Tank
  Real level(start = 1;
equation
  der(level) := -level;
end Tonk;
