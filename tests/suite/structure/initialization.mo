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

//@ case equal_starts
// Two pieces of one line that are joined carry one current, and both say where it begins.
model Joined
  Real a;
  Real b;
  Real c;
  Real d;
initial equation
  a = 0;
  c = 0;
equation
  der(a) + der(c) = 2;
  a = b;
  c = d;
  b = d;
end Joined;
//@ expect a = 1 rel 1e-9

//@ case different_starts
model Joined
  Real a;
  Real b;
  Real c;
  Real d;
initial equation
  //@ error[MO0408] 3-7
  a = 0;
  c = 1;
equation
  der(a) + der(c) = 2;
  a = b;
  c = d;
  b = d;
end Joined;
