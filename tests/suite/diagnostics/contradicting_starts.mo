// status: 1
// error[MO0408] 5:8
// FIXME: should name `b` and its line, not its alias `der(a)`.
model Levels
  Real a(start = 1, fixed = true);
  Real b(start = 2, fixed = true);
equation
  der(a) = -b;
  b = 3*a;
end Levels;
