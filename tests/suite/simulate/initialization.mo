//@ case no_initial_solution
//@ status 3
model Parabola
  Real x(start = 1);
  Real y;
initial equation
  //@ error[MO0904] 3-13
  x^2 + 1 = 0;
equation
  der(x) = y;
  y = -x;
end Parabola;
