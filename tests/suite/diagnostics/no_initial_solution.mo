// status: 3
// error[MO0903] 8:3
// FIXME: should say that no start is found; the matrix is singular only where the iteration got stuck.
model Parabola
  Real x(start = 1);
  Real y;
initial equation
  x^2 + 1 = 0;
equation
  der(x) = y;
  y = -x;
end Parabola;
