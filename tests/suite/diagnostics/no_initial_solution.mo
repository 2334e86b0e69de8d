// status: 3
// error[MO0904] 7:3
model Parabola
  Real x(start = 1);
  Real y;
initial equation
  x^2 + 1 = 0;
equation
  der(x) = y;
  y = -x;
end Parabola;
