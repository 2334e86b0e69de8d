// Written backwards: sorting alone solves it.
model Sorted
  Real x(start = 1, fixed = true);
  Real a;
  Real b;
  Real c;
equation
  der(x) = -a;
  a = 2*b + 1;
  b*3 = c;
  c - sin(x) = 0;
end Sorted;
