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

//@ case preferred_states
//@ run stop=1 tolerance=1e-9
// The balances are of mass and energy, but the model prefers pressure and temperature: m = p/(R T), U = c m T.
model Volume
  constant Real R = 287, c = 717;
  Real m, U;
  Real p(start = 1e5, fixed = true, stateSelect = StateSelect.prefer);
  Real T(start = 300, fixed = true, stateSelect = StateSelect.prefer);
equation
  m = p/(R*T);
  U = m*c*T;
  der(m) = 0.1;
  der(U) = 1e4;
end Volume;
//@ let mass = 1e5/(287*300) + 0.1
//@ let energy = 1e5*717/287 + 1e4
//@ expect structure has 1 "states (2): p, T"
//@ expect p = energy*287/717 rel 1e-8
//@ expect T = energy/(717*mass) rel 1e-8

//@ case a_preferred_variable_that_jumps_is_no_state
//@ run stop=1 tolerance=1e-9
model Charge
  Real q(start = 1, fixed = true);
  Real u(stateSelect = StateSelect.prefer);
equation
  der(q) = -q;
  q = (if time > 0.5 then 2 else 1)*u;
end Charge;
//@ expect structure has 1 "states (1): q"
//@ expect q = exp(-1) abs 1e-8
//@ expect u = exp(-1)/2 abs 1e-8

//@ case a_term_that_jumps_moves_no_state
//@ run stop=1 tolerance=1e-9
// A state keeps its value at an event: z' = 1 - z, then z' = 3 - z.
model Sum
  Real q(start = 0, fixed = true);
  Real x, z(start = 0, fixed = true);
equation
  der(q) = 1;
  x = if q < 0.5 then q else 3*q;
  der(z) = der(x) - z;
end Sum;
//@ expect z = 3 - (3 - (1 - exp(-0.5)))*exp(-0.5) abs 1e-7
