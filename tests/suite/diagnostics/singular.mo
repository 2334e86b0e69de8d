// status: 1
// error[MO0401] 6:8
// error[MO0402] 9:3
model Levels
  Real a;
  Real b;
  Real c;
equation
  a = time;
  a = sin(time);
  b + c = 1;
end Levels;
