// status: 1
// error[MO0401] 5:8
// error[MO0402] 9:3
model Levels
  Real b;
  Real a;
  Real c;
equation
  a = time;
  a = sin(time);
  b + c = 1;
end Levels;
