//@ case contradicting_starts
// FIXME: should name `b` and its line, not its alias `der(a)`.
model Levels
  //@ error[MO0408] 8
  Real a(start = 1, fixed = true);
  Real b(start = 2, fixed = true);
equation
  der(a) = -b;
  b = 3*a;
end Levels;
