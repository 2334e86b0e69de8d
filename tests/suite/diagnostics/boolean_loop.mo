// status: 3
// error[MO0905] 9:3
model Twice
  Real x(start = 1, fixed = true);
  Boolean b;
  Boolean c;
equation
  der(x) = if b then 1 else -1;
  b = not c;
  c = b;
end Twice;
