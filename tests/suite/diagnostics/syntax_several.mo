// status: 1
// error[MO0004] 8:23
// error[MO0007] 11:14
// error[MO0007] 12:7
// error[MO0006] 15:1
// error[MO0005] 15:5
model Tank
  Real level(start = 1;
  Real out;
equation
  der(level) := -out;
  out == 2*level;
  if level > 0.5 then
    out = 1;
end Tonk;
