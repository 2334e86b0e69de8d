//@ case pendulum
//@ snapshot structure
// Index 3: the length is differentiated twice, and two of four candidates are states.
model Pendulum
  Real x(start = 0.6, fixed = true, stateSelect = StateSelect.prefer);
  Real y(start = -0.8);
  Real v(start = 0, fixed = true, stateSelect = StateSelect.prefer) = der(x);
  Real w = der(y);
  Real F;
equation
  der(v) = -F*x;
  der(w) = -F*y - 9.81;
  x^2 + y^2 = 1;
end Pendulum;
// One position and one velocity (Mattsson, Olsson & Elmqvist 2000), whichever the angle allows.
//@ expect structure has 1 "selected while running, 1 of (2): x, y"
//@ expect structure has 1 "selected while running, 1 of (2): v, w"
//@ expect structure has 1 "differentiated twice"
