// status: 1
// error[MO0003] 4:24
model Tank
  Real level(start = 1)
equation
  der(level) = -level;
end Tank;
