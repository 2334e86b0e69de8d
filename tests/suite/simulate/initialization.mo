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

//@ case initial_equations_choose_branches
// At the start a Boolean may follow from variables that are continuous later.
model Branch
  function is_high
    input Real x;
    output Boolean b;
  algorithm
    b := x > 0.5;
  end is_high;
  final parameter Boolean high(fixed = false);
  Real x(start = 1, fixed = true);
initial equation
  high = is_high(x);
equation
  der(x) = if high then -1 else 1;
end Branch;
//@ expect der(x) = -1

//@ case when_initial
// Only `initial()` itself makes a when-clause active at the start.
model Start
  function same
    input Boolean b;
    output Boolean y;
  algorithm
    y := b;
  end same;
  Real x(start = 1, fixed = true);
  Real y(start = 1, fixed = true);
equation
  when same(initial()) then
    x = 2;
  end when;
  when initial() then
    y = 2;
  end when;
end Start;
//@ expect x, y = 1, 2

//@ case free_boolean_parameter
model Found
  parameter Real limit(fixed = false);
  parameter Boolean exceeded(fixed = false);
  Real y = if exceeded then limit else -limit;
initial algorithm
  limit := 3;
  exceeded := false;
  if limit > 2 then
    exceeded := true;
    limit := 2;
  end if;
end Found;
//@ expect exceeded, y = 1, 2

//@ case homotopy
//@ run stop=0.1
// Newton's iteration for `x^3 - 2 x + 2 = 0` stays near 0.8 from the right, where the left side
// has its least value; the only root is far to the left. The simplified equation leads there.
model Far
  Real x(start = 1);
equation
  0 = homotopy(actual = x^3 - 2*x + 2, simplified = x + 2);
end Far;
// Cardano's formula.
//@ let root = -(cbrt(1 + sqrt(1 - 8/27)) + cbrt(1 - sqrt(1 - 8/27)))
//@ expect x at start = root rel 1e-12
//@ expect x = root rel 1e-12

//@ case search_for_a_change_of_sign
//@ run stop=0.1
// Without a simplified equation a change of sign is searched for at last, outwards from the guess.
model Far
  Real x(start = 1);
equation
  0 = x^3 - 2*x + 2;
end Far;
//@ let root = -(cbrt(1 + sqrt(1 - 8/27)) + cbrt(1 - sqrt(1 - 8/27)))
//@ expect x at start = root rel 1e-12

//@ case no_root
//@ run stop=0.1
//@ status 3
model Far
  Real x(start = 1);
equation
  //@ error[MO0904] 3-19
  0 = x^4 - 2*x + 2;
end Far;

//@ case homotopy_is_not_needed
//@ run stop=0.1
// Where the guess serves, the simplified equation is not looked at: it has no solution here.
model Direct
  Real x(start = 1);
equation
  0 = homotopy(actual = x^2 - 2, simplified = x^2 + 1);
end Direct;
//@ expect x at start = sqrt(2) rel 1e-14

//@ case the_start_value_decides
//@ run stop=0.1
model Two
  Real positive(start = 0.5);
  Real negative(start = -0.5);
equation
  positive^2 = 4;
  negative^2 = 4;
end Two;
//@ expect positive, negative at start = 2, -2 rel 1e-14

//@ case bounds_decide
//@ run stop=0.1
// Bounds keep the iteration where the solution makes sense, wherever it begins.
model Bounded
  Real above[2](start = {1, -1}, each min = 0.1);
  Real below[2](start = {1, -1}, each max = -0.1);
equation
  for k in 1:2 loop
    above[k]^2 = 4;
    below[k]^2 = 4;
  end for;
end Bounded;
//@ expect above[1:2] at start = 2 rel 1e-14
//@ expect below[1:2] at start = -2 rel 1e-14

//@ case solution_beyond_the_bounds
//@ run stop=0.1
// `min` and `max` do not make a solution beyond them impossible.
model Beyond
  //@ warning[MO0919] 8
  Real x(start = 1, max = 1.5);
equation
  x^3 = 8;
end Beyond;
//@ expect x at start = 2 rel 1e-14

//@ case free_parameter
//@ run stop=1 tolerance=1e-9
model Tuned
  parameter Real k(fixed = false, start = 1);
  Real x(start = 1, fixed = true);
initial equation
  der(x) = -3;
equation
  der(x) = -k ^ 2 * x;
end Tuned;
//@ expect x = exp(-3) rel 1e-7

//@ case steady_state_and_free_parameter
// Steady state at the start; the stiffness follows from a wanted frequency.
model Steady
  parameter Real c(fixed = false, start = 1);
  parameter Real omega = 7;
  Real s;
  Real v;
  Real x;
  Real found = c;
initial equation
  der(x) = 0;
  sqrt(c/2) = omega;
  s = 1;
  v = 0;
equation
  der(s) = v;
  2*der(v) = -c*s;
  der(x) = 4 - x;
  annotation(experiment(StopTime = 1, Tolerance = 1e-9));
end Steady;
//@ expect found at start = 98 rel 1e-9
//@ expect each x = 4 abs 1e-12
//@ expect s = cos(7) rel 1e-6

//@ case starts_that_newton_cannot_take
// A logarithm of zero at the start, a law of flow whose slope is zero there, and a pair of closed valves in series.
package Starts
  model Logarithm
    Real ratio;
    Real y = 2*log(ratio) + 1;
  equation
    y = 1 + 2*log(3);
  end Logarithm;
  model Temperature
    parameter Real h = 3e5;
    Real T(nominal = 300, min = 1);
  equation
    h = 1000*T + 2e6/T*log(T/300);
  end Temperature;
  model ZeroFlow
    Real m, p, q;
  equation
    m*abs(m) = 4 - p;
    q*abs(q) = p - 1;
    m = q;
  end ZeroFlow;
  model Top
    Logarithm logarithm;
    Temperature temperature;
    ZeroFlow pipe;
  end Top;
end Starts;
//@ expect logarithm.ratio = 3 rel 1e-12
//@ expect temperature.T = 300 rel 1e-9
//@ expect pipe.m, pipe.p = sqrt(1.5), 2.5 rel 1e-9

//@ case relations_that_many_equations_wait_for
// Where a vessel counts as empty, nothing determines its pressure: that is so for all of them until the first pass has
// computed the levels.
model Vessels
  parameter Integer n = 20;
  Real level[n];
  Real p[n](each start = 1);
  Boolean is_covered[n];
initial equation
  level = {2 + k for k in 1:n};
equation
  der(level) = -level;
  for k in 1:n loop
    is_covered[k] = level[k] >= 0.5;
    0 = if is_covered[k] then p[k]^3 - level[k] else level[k] - 1;
  end for;
  annotation(experiment(StopTime = 0.5));
end Vessels;
//@ expect p[1], p[6], p[20] at start = 3^(1/3), 2, 22^(1/3) rel 1e-12
//@ expect p[6] = 2*exp(-0.5/3) rel 1e-5

//@ case relations_of_a_loop
// The loop needs its phase before its enthalpy is known: with the second phase it has no solution.
model Medium
  Real h(start = 1);
  Integer phase;
  Real d;
  Real q(start = 1);
equation
  phase = if h < 2 then 1 else 2;
  d = if phase == 1 then 3 + 0.1*h else -5;
  q^4 + q^2 = d;
  h = 1 + 0.01*q^2;
  annotation(experiment(StopTime = 1));
end Medium;
//@ expect phase = 1
//@ expect q = sqrt((-0.999 + sqrt(0.999^2 + 4*3.1))/2) rel 1e-9

//@ case relations_known_after_a_failed_pass
// The border between the phases has no start value: only the pass that fails computes it.
model Medium
  Real border = 2 + time;
  Real h(start = 1);
  Integer phase;
  Real d;
  Real q(start = 1);
equation
  phase = if h < border then 1 else 2;
  d = if phase == 1 then 3 + 0.1*h else -5;
  q^4 + q^2 = d;
  h = 1 + 0.01*q^2;
  annotation(experiment(StopTime = 1));
end Medium;
//@ expect phase = 1
//@ expect q = sqrt((-0.999 + sqrt(0.999^2 + 4*3.1))/2) rel 1e-9

//@ case relations_that_begin_wrongly
// At the start values the pump seems to run, and then nothing determines its flow.
model Pump
  Real head(start = 3);
  Real q(start = 1);
  Boolean runs = head > 2;
equation
  0 = if runs then head - 3*head else q + head - 2;
  head = 1 + q^2;
  annotation(experiment(StopTime = 1));
end Pump;
//@ expect runs = 0
//@ expect q = (-1 + sqrt(5))/2 rel 1e-9

//@ case values_of_free_parameters
// Section 8.6: a value beside `fixed = false` deserves a diagnostic; it is used where no initial equation determines the
// parameter, before its start attribute.
model Springs
  //@ warning[MO0337] 18
  parameter Real c(fixed = false) = 2000;
  //@ warning[MO0337] 18
  parameter Real d(start = 5, fixed = false) = 30;
  Real f = c*0.01;
initial equation
  f = 40;
end Springs;
//@ expect c, d, f = 4000, 30, 40
