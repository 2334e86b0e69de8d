// Index 3: the length is differentiated twice, and two of four candidates are states.
model Pendulum
  Real x(start = 0.6, fixed = true, stateSelect = StateSelect.prefer);
  Real y(start = -0.8);
  Real vx(start = 0, fixed = true, stateSelect = StateSelect.prefer) = der(x);
  Real vy = der(y);
  Real F;
equation
  der(vx) = -F*x;
  der(vy) = -F*y - 9.81;
  x^2 + y^2 = 1;
end Pendulum;
