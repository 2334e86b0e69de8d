//@ case a_term_is_added_where_the_rate_is_not
//@ run stop=1 tolerance=1e-9
model Rotor
  parameter Real J = 2;
  Real phi(start = 0, fixed = true);
  Real w(start = 1, fixed = true);
equation
  der(phi) = w;
  J*der(w) = -4*w;
end Rotor;
model Driven
  extends Rotor;
  Real push = 4*w + 6;
  annotation(__mocc(adds = "der(w) = push"));
end Driven;
// 2 w' = 6.
//@ expect w at 1 = 4 abs 1e-8
//@ expect phi at 1 = 2.5 abs 1e-8

//@ case a_positive_term_increases_the_rate_however_it_is_written
//@ run stop=1 tolerance=1e-9
model Four
  Real a(start = 0, fixed = true);
  Real b(start = 0, fixed = true);
  Real c(start = 0, fixed = true);
  Real d(start = 0, fixed = true);
  Real acceleration = (1 - c)/2;
  Real power;
equation
  0 = 1 - 2*der(a);
  1 - der(b)/2 = b;
  der(c) = acceleration;
  power = der(d);
  3*power = 2 - d;
end Four;
model More
  extends Four;
  Real one = 1;
  Real balanced_b = b + 1;
  Real balanced_c = c/2;
  Real balanced_d = d;
  annotation(__mocc(adds = "der(a) = one, der(b) = balanced_b, der(c) = balanced_c, der(d) = balanced_d"));
end More;
// 2 a' = 2,   b'/2 = 2,   c' = 1/2,   3 d' = 2.
//@ expect a at 1 = 1 abs 1e-8
//@ expect b at 1 = 4 abs 1e-8
//@ expect c at 1 = 0.5 abs 1e-8
//@ expect d at 1 = 2/3 abs 1e-8

//@ case coupled_equations_have_one_rate_each
//@ run stop=1 tolerance=1e-9
model Coupled
  Real x[1,2](start = {{0, 0}}, each fixed = true);
equation
  2*der(x[1,1]) + der(x[1,2]) = 3;
  der(x[1,1]) + 2*der(x[1,2]) = 3;
end Coupled;
model Pushed
  extends Coupled;
  Real push = 3;
  annotation(__mocc(adds = "der(x[1,2]) = push"));
end Pushed;
// 2 a + b = 3,   a + 2 b = 6.
//@ expect x[1,1] at 1 = 0 abs 1e-8
//@ expect x[1,2] at 1 = 3 abs 1e-8

//@ case a_variable_has_an_equation_that_is_solved_for_it
//@ run stop=1 tolerance=1e-9
model Spring
  Real s = sin(time);
  Real F = 2*s;
  Real G;
equation
  3*s + 1 = G;
end Spring;
model Stiff
  extends Spring;
  Real cube = s^3;
  annotation(__mocc(adds = "F = cube, G = cube"));
end Stiff;
//@ expect F at 1 = 2*sin(1) + sin(1)^3 abs 1e-9
//@ expect G at 1 = 3*sin(1) + 1 + sin(1)^3 abs 1e-9

//@ case an_offset_is_added_to_a_start
//@ run stop=1 tolerance=1e-9
model Decay
  parameter Real x_0 = 2;
  Real x(start = x_0, fixed = true);
equation
  der(x) = -x;
end Decay;
model Higher
  extends Decay;
  parameter Real d = 0.5;
  annotation(__mocc(starts = "x = d"));
end Higher;
//@ expect x at 0 = 2.5 abs 1e-9
//@ expect x at 1 = 2.5*exp(-1) abs 1e-8

//@ case starts_that_take_no_offset
model Decay
  Real x(start = 2);
  Real y(start = 1, fixed = true);
equation
  der(x) = -x;
  der(y) = -y;
  //@ error[MO0336] 30-43: `x` is not a variable whose declaration fixes its start
  //@ error[MO0336] 30-43: `y` is not a `Real` parameter of the model
  annotation(__mocc(starts = "x = y, y = y"));
end Decay;

//@ case terms_that_no_equation_takes
model Rotor
  Real phi(start = 0, fixed = true);
  Real w(start = 1, fixed = true);
equation
  der(phi) = w;
  der(w) = -w;
  //@ error[MO0329] 28-41: no equation is written for `der(phi)`
  annotation(__mocc(adds = "der(phi) = w"));
end Rotor;
