//@ case algebraic_loop_without_solution
//@ status 3
model Loop
  Real x(start = 1);
equation
  //@ error[MO0904] 3-17
  x^2 = -1 - time;
end Loop;

//@ case boolean_loop
//@ status 3
model Twice
  Real x(start = 1, fixed = true);
  Boolean b;
  Boolean c;
equation
  der(x) = if b then 1 else -1;
  //@ error[MO0905] 3-11
  b = not c;
  c = b;
end Twice;

//@ case dependent_equations
// A ring of differences has two independent equations in three: the level stays free, the rest is determined.
model Ring
  Real a;
  Real b;
  Real c;
  Real x(start = 0, fixed = true);
equation
  a - b = sin(time);
  //@ warning[MO0410] 3-19
  b - c = cos(time);
  c - a = -sin(time) - cos(time);
  der(x) = a - c;
  annotation(experiment(StopTime = 1, Tolerance = 1e-9));
end Ring;
//@ expect a - b = sin(1) rel 1e-12
//@ expect b - c = cos(1) rel 1e-12
//@ expect x = 1 - cos(1) + sin(1) rel 1e-8
//@ expect messages has "do not determine `a`, `b` and `c`"

//@ case dependent_equations_that_change
// Coefficients that change with the time: the equations repeat each other at all times.
model Ring
  Real g = 1 + time;
  Real a;
  Real b;
  Real c;
  Real x(start = 0, fixed = true);
equation
  //@ warning[MO0410] 3-25
  g*(a - b) = g*sin(time);
  g*(b - c) = g*cos(time);
  g*(c - a) = -g*(sin(time) + cos(time));
  der(x) = a - c;
  annotation(experiment(StopTime = 1, Tolerance = 1e-9));
end Ring;
//@ expect x = 1 - cos(1) + sin(1) rel 1e-8
//@ expect messages has "do not determine `a`, `b` and `c`"

//@ case nonlinear_equations_that_repeat_each_other
// Whatever the values are, the second equation says what the first one says.
model Product
  Real a;
  Real b;
  Real x(start = 0, fixed = true);
equation
  //@ error[MO0410] 3-23
  sin(a)*b = cos(x) + 1;
  2*sin(a)*b = 2*cos(x) + 2;
  der(x) = a;
end Product;

//@ case undetermined_in_one_branch
// What is singular in one branch only is seen by the simulation, also if no step evaluates it again.
model Branch
  Real x(start = 3);
  Real y(start = 3);
  Real z(start = 0, fixed = true);
equation
  if time < 0.5 then
    //@ warning[MO0918] 5-9
    x = y;
  else
    x = 1;
  end if;
  y = x;
  der(z) = x;
  annotation(experiment(StopTime = 1));
end Branch;
//@ expect z = 2 rel 1e-6
//@ expect messages has "at time 0 s nothing determines `x`"

//@ case coefficients_that_vanish
// A winding at an angle: of its two components one vanishes, at 0 exactly, at pi/2 by rounding.
model Winding
  parameter Real angle = 0;
  parameter Real n[2] = 5*{cos(angle), sin(angle)};
  Real phi[2];
  Real i(start = 0, fixed = true);
  Real u = exp(-time);
equation
  phi = n*i/25;
  u = n*der(phi);
  annotation(experiment(StopTime = 1, Tolerance = 1e-9));
end Winding;
//@ run set=angle=0
//@ expect i = 1 - exp(-1) rel 1e-8
//@ run set=angle=1
//@ expect i = 1 - exp(-1) rel 1e-8
//@ run set=angle=1.5707963267948966
//@ expect i = 1 - exp(-1) rel 1e-8
//@ run set=angle=3.141592653589793
//@ expect i = 1 - exp(-1) rel 1e-8

//@ case ideal_switches
// Two switches in opposite directions, one of them closed: the remaining voltage across them is
// 1e-9 of the current, and must not be a rounding error of the adjacent voltages.
model Pair
  Real i(start = 1e-3, fixed = true);
  Real left = 100*cos(time);
  Real right;
  Real s1;
  Real s2;
  Real i1;
  Real i2;
  Real v1;
  Real v2;
  Boolean off = time > 10;
equation
  v1 = left - right;
  v2 = right - left;
  v1 = s1*(if off then 1 else 1e-9);
  i1 = s1*(if off then 1e-9 else 1);
  v2 = s2*(if not off then 1 else 1e-9);
  i2 = s2*(if not off then 1e-9 else 1);
  i = i1 - i2;
  der(i) = -i;
end Pair;
// The other switch takes 1e-18 of it.
//@ expect i1, s1 = i rel 1e-15

//@ case kepler
// E - e sin(E) = M, checked by inserting the solution; the loop is torn to one unknown.
model Kepler
  parameter Real e = 0.6;
  Real M = 2*time;
  Real E(start = 0);
  Real r;
equation
  E = M + e*sin(E);
  r = 1 - e*cos(E);
  annotation(experiment(StopTime = 6));
end Kepler;
//@ expect each E - 0.6*sin(E) = 2*time abs 1e-9
//@ expect E at pi/2 = pi abs 0.02

//@ case network_of_springs
// Solved one node after another, the springs between nodes multiply rounding errors by 2.6 in each.
// The first mode is xm = sin(i*theta)*cos(w*t), and the nodes follow with a ratio of 1/(3 - 2*cos(theta)).
model SpringNetwork
  parameter Integer N = 40;
  parameter Real m = 1;
  parameter Real k = 10;
  parameter Real theta = 3.141592653589793/(N + 1);
  Real xm[N](start = {sin(i*theta) for i in 1:N}, each fixed = true);
  Real v[N](each start = 0, each fixed = true);
  Real xs[N];
equation
  for i in 1:N loop
    der(xm[i]) = v[i];
    m*der(v[i]) = k*(xs[i] - xm[i]);
  end for;
  k*(xs[1] - xm[1]) + k*xs[1] + k*(xs[1] - xs[2]) = 0;
  for i in 2:N - 1 loop
    k*(xs[i] - xm[i]) + k*(xs[i] - xs[i - 1]) + k*(xs[i] - xs[i + 1]) = 0;
  end for;
  k*(xs[N] - xm[N]) + k*(xs[N] - xs[N - 1]) + k*xs[N] = 0;
  annotation(experiment(StopTime = 10));
end SpringNetwork;
//@ let theta = pi/41
//@ let ratio = 1/(3 - 2*cos(theta))
//@ expect each xs[7] = ratio*xm[7] abs 1e-9
//@ expect xm[20] = sin(20*theta)*cos(sqrt(10*(1 - ratio))*10) abs 1e-4

//@ case sparse_network
// So many torn unknowns that the matrix is decomposed by its entries.
model Grid
  parameter Integer N = 300;
  parameter Real theta = 3.141592653589793/(N + 1);
  Real u[N] = {time*sin(i*theta) for i in 1:N};
  Real x[N];
equation
  3*x[1] - x[2] = u[1];
  for i in 2:N - 1 loop
    3*x[i] - x[i - 1] - x[i + 1] = u[i];
  end for;
  3*x[N] - x[N - 1] = u[N];
end Grid;
//@ let theta = pi/301
//@ expect each x[1] = time*sin(theta)/(3 - 2*cos(theta)) abs 1e-12
//@ expect each x[150] = time*sin(150*theta)/(3 - 2*cos(theta)) abs 1e-12
