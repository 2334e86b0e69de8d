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

//@ case rest_and_a_fixed_start
// Three conditions for two states. That two of them state the same number does not make them the same.
model Oven
  Real T;
  //@ error[MO0408] 8
  Real u(start = 0, fixed = true);
initial equation
  der(u) = 0;
  der(T) = 0;
equation
  der(T) = 20*u - (T - 290);
  der(u) = 350 - T;
end Oven;

//@ case rest_that_follows_from_a_fixed_start
// At these values rest is where the controller begins.
model Oven
  parameter Real goal = 350;
  Real T;
  Real u(start = 3, fixed = true);
initial equation
  der(u) = 0;
  der(T) = 0;
equation
  der(T) = 20*u - (T - 290);
  der(u) = goal - T;
end Oven;
//@ run stop=1
//@ expect T = 350 rel 1e-9
//@ expect u = 3 rel 1e-9

//@ case rest_that_another_parameter_prevents
model Oven
  parameter Real goal = 350;
  Real T;
  //@ error[MO0408] 8
  Real u(start = 3, fixed = true);
initial equation
  der(u) = 0;
  der(T) = 0;
equation
  der(T) = 20*u - (T - 290);
  der(u) = goal - T;
end Oven;
//@ run set=goal=360

//@ case a_start_that_a_gear_repeats
// The second start follows from the first for every ratio.
model Gear
  parameter Real ratio = 3;
  parameter Real w0 = 6;
  Real w1(start = w0, fixed = true);
  Real w2(start = w0/ratio, fixed = true);
  Real torque;
equation
  der(w1) = -torque;
  der(w2) = ratio*torque;
  w1 = ratio*w2;
end Gear;
//@ run stop=1
//@ expect w2 = 2 rel 1e-9

//@ case currents_of_a_node_that_all_start_in_the_same_way
// Each of the three conditions follows from the other two, but only if all equations are solved together.
model Coils
  parameter Real k = -1;
  parameter Real R = 2;
  parameter Real L = 0.5;
  Real i, i1, i2;
  Real v;
initial equation
  der(i) = k*i;
  der(i1) = k*i1;
  der(i2) = k*i2;
equation
  i = i1 + i2;
  10 = L*der(i) + R*i + v;
  v = L*der(i1) + R*i1;
  v = 3*L*der(i2) + R*i2;
end Coils;
//@ run stop=1
// v = (R + k*L)*i1 = (R + 3*k*L)*i2.
//@ expect v at start = 2 rel 1e-9
//@ expect i, i1, i2 at start = 16/3, 4/3, 4 rel 1e-9

//@ case currents_of_a_node_that_start_in_different_ways
model Coils
  parameter Real k = -1;
  Real i, i1, i2;
  Real v;
initial equation
  //@ error[MO0408] 3-14
  der(i) = k*i;
  der(i1) = k*i1;
  der(i2) = 2*k*i2 + 1;
equation
  i = i1 + i2;
  10 = der(i) + 4*i + v;
  v = der(i1) + 4*i1;
  v = 3*der(i2) + 4*i2;
end Coils;

//@ case a_start_of_a_constant
model Tank
  //@ error[MO0408] 8-12
  Real level(start = 1, fixed = true);
  Real volume(start = 0, fixed = true);
equation
  level = 5;
  der(volume) = level;
end Tank;
//@ expect messages has "the equations give `level` the value `5.0`"

//@ case a_start_that_a_constant_repeats
model Tank
  parameter Real height = 5;
  Real level(start = 5, fixed = true);
  Real volume(start = 0, fixed = true);
equation
  level = height;
  der(volume) = level;
end Tank;
//@ run stop=1
//@ expect volume = 5 rel 1e-9

//@ case an_assertion_about_the_start
model Tank
  Real level(start = 1, fixed = true);
equation
  //@ error[MO0912] 3-65
  assert(not initial() or level > 2, "the tank begins too empty");
  der(level) = 1;
end Tank;
//@ status 3

//@ case an_open_start_is_that_of_the_first_name
// Two conditions for three states: of the starts that may be assumed, the first by name is, whatever the order
// of the declarations; `a = 1` leads to `b = (4 - a)/3` and `c = 2 - a`.
model Open
  Real c(start = 5);
  Real b(start = 7);
  Real a(start = 1);
initial equation
  a + 3*b = 4;
  der(a) = 2;
equation
  der(c) = -c;
  der(b) = -b;
  der(a) = a + c;
end Open;
//@ run stop=1
//@ expect a at 0 = 1 rel 1e-9
//@ expect b at 0 = 1 rel 1e-9
//@ expect c at 0 = 1 rel 1e-9

//@ case an_open_start_of_tied_states
// Of two states that are tied, the first by name keeps its start.
model Tied
  Real w10(start = 3);
  Real w9(start = 5);
  Real torque;
equation
  der(w10) = torque;
  der(w9) = 1 - torque;
  w10 = w9;
end Tied;
//@ run stop=1
//@ expect w9 at 0 = 5 rel 1e-9
//@ expect w10 at 0 = 5 rel 1e-9
//@ expect w9 = 5.5 rel 1e-6

//@ case an_open_start_with_a_repeated_condition
model Repeated
  Real y(start = 4);
  Real x(start = 2);
initial equation
  der(x) = 3;
  der(x) = 3;
equation
  der(x) = x + y;
  der(y) = -y;
end Repeated;
//@ run stop=1
//@ expect x at 0 = 2 rel 1e-9
//@ expect y at 0 = 1 rel 1e-9

//@ case a_rest_that_the_others_imply
// The start of the level follows from the other two, by an equation that is solved by iteration: it is checked.
model Basins
  Real level(start = 4, fixed = true);
  Real q(start = 1);
  Real other(start = 1);
initial equation
  der(level) = 0;
equation
  q^3 + q = 10;
  other + 0.1*sin(other)*q = level;
  der(level) = 10 - q^3 - q*level/4;
end Basins;
//@ run stop=1
//@ expect q = 2 rel 1e-6
//@ expect level = 4 rel 1e-6

//@ case a_loop_with_an_angle_of_zero
// At an angle of zero the second term vanishes: neither equation may be solved for the imaginary part by it.
model Transformer
  parameter Real r = 2;
  parameter Real theta = 0;
  Real re, im;
  Real x, y;
equation
  r*cos(theta)*re - r*sin(theta)*im = x;
  r*sin(theta)*re + r*cos(theta)*im = y;
  x = 10 - 0.5*re + 0.1*im;
  y = 4 - 0.5*im - 0.1*re;
end Transformer;
// 2.5*re - 0.1*im = 10 and 0.1*re + 2.5*im = 4.
//@ expect re = (2.5*10 + 0.1*4)/(2.5^2 + 0.1^2) rel 1e-9
//@ expect im = (2.5*4 - 0.1*10)/(2.5^2 + 0.1^2) rel 1e-9
