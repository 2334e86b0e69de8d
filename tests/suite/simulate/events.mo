//@ case sampled_counter
model Counter
  Integer n(start = 0, fixed = true);
  Real last(start = -1, fixed = true);
equation
  when sample(0.1, 0.25) then
    n = pre(n) + 1;
    last = time;
  end when;
  annotation(experiment(StopTime = 2));
end Counter;
// 0.1, 0.35, ... 1.85
//@ expect n = 8
//@ expect last = 1.85 rel 1e-14
//@ expect n at 0.849, 0.85 = 3, 4
//@ expect events = 8

//@ case thermostat
// Heating towards 30, cooling towards 10, both with 1 s; between 18 and 22 a period takes
// ln(12/8) both ways.
model Thermostat
  Real T(start = 18, fixed = true);
  Boolean on(start = true, fixed = true);
  Integer switches(start = 0, fixed = true);
equation
  der(T) = (if on then 30 else 10) - T;
  when T > 22 then
    on = false;
  elsewhen T < 18 then
    on = true;
  end when;
  when change(on) then
    switches = pre(switches) + 1;
  end when;
  annotation(experiment(StopTime = 4, Tolerance = 1e-9));
end Thermostat;
//@ let half = log(1.5)
//@ expect events "T > 22.0 became true" = 5 at half*(2*k - 1) rel 1e-7
//@ expect events "T < 18.0 became true" = 4 at half*2*k rel 1e-7
//@ expect switches = 9

//@ case the_first_branch_of_elsewhen
model Both
  Integer which(start = 0, fixed = true);
equation
  when time >= 1 then
    which = 1;
  elsewhen time >= 1 then
    which = 2;
  elsewhen time >= 2 then
    which = 3;
  end when;
  annotation(experiment(StopTime = 3));
end Both;
//@ expect which at 0.99, 1, 3 = 0, 1, 3

//@ case event_iteration
model Cascade
  Boolean a(start = false, fixed = true);
  Integer n(start = 0, fixed = true);
  Integer m(start = 0, fixed = true);
  Real x(start = 0, fixed = true);
equation
  der(x) = 1;
  when x >= 0.5 then
    a = true;
    reinit(x, 2);
  end when;
  when {a, x > 1.5} then
    n = pre(n) + 1;
  end when;
  when edge(a) then
    m = pre(m) + 1;
  end when;
  annotation(experiment(StopTime = 1));
end Cascade;
// Two relations at one instant, in two rows: a jump of x, and each clause active once per cause.
//@ expect events = 2 at 0.5 abs 1e-9
//@ expect event[1] = event[2]
//@ expect rows = 2 where time == event[1]
//@ expect x = 2.5 rel 1e-9
//@ expect m, n = 1, 2

//@ case switched_equations
// Exact: rises with slope 2 to 1, then decays.
model Switched
  Real x(start = 0, fixed = true);
  Boolean charging;
  Real u;
equation
  charging = time < 0.5;
  if charging then
    der(x) = 2;
    u = x;
  else
    u = -x;
    der(x) = u;
  end if;
  annotation(experiment(StopTime = 1.5, Tolerance = 1e-9));
end Switched;
//@ expect x at 0.5 = 1 rel 1e-9
//@ expect x = exp(-1) rel 1e-7
//@ expect events "time < 0.5 became false" = 1 at 0.5

//@ case terminate
model Fall
  Real h(start = 5, fixed = true);
equation
  der(h) = -2;
  when h < 1 then
    terminate("landed");
  end when;
  annotation(experiment(StopTime = 10));
end Fall;
//@ expect time = 2 rel 1e-9

//@ case clock_from_initialization
//@ run stop=1 tolerance=1e-9
// The mean of a sine over each of its periods is 0, whatever the time at which the run begins.
model Mean
  parameter Real f = 5;
  parameter Real t_0(fixed = false);
  Real u = 2 + sin(2*3.141592653589793*f*time);
  Real x(start = 0, fixed = true);
  discrete Real y(start = 0, fixed = true);
  discrete Real n(start = 0, fixed = true);
initial equation
  t_0 = time + 0.05;
equation
  der(x) = u;
  when sample(t_0 + 1/f, 1/f) then
    y = f*pre(x);
    n = pre(n) + 1;
    reinit(x, 0);
  end when;
end Mean;
//@ expect n = 4
//@ expect y = 2 abs 1e-7
//@ expect events = 4 at 0.25, 0.45, 0.65, 0.85 abs 1e-12

//@ case sampled_pi_controller
//@ run stop=3.05 interval=0.05 tolerance=1e-10
// The plant `x' = u - x` under `u = K e + I` at multiples of `T`: by the exact map of a period,
// `x := a x + (1 - a) u` with `a = exp(-T)`.
model Controlled
  parameter Real K = 2, Ki = 3, T = 0.1, r = 1;
  Real x(start = 0, fixed = true);
  discrete Real i(start = 0, fixed = true);
  discrete Real u(start = 0, fixed = true);
equation
  der(x) = u - x;
  when sample(0, T) then
    i = pre(i) + Ki*T*(r - x);
    u = K*(r - x) + i;
  end when;
end Controlled;
//@ let a = exp(-0.1)
//@ let output(x, i) = 2*(1 - x) + i
//@ let next(x, i) = a*x + (1 - a)*output(x, i)
//@ let sampled(n, x, i) = if n == 0 then x else sampled(n - 1, next(x, i), i + 0.3*(1 - next(x, i)))
//@ let held(n, x, i) = if n == 0 then output(x, i) else held(n - 1, next(x, i), i + 0.3*(1 - next(x, i)))
//@ let tick = floor(10*time + 0.5)
//@ expect each x = sampled(tick, 0, 0.3) where abs(10*time - tick) < 1e-6 abs 1e-8
//@ expect each u = held(floor(10*time), 0, 0.3) where abs(10*time - tick) > 0.1 abs 1e-8
//@ expect rows >= 30 where abs(10*time - tick) > 0.1

//@ case ball_results
//@ used by results.rs
model Ball
  Real h(start = 1, fixed = true);
  Real v(start = 0, fixed = true);
  Boolean touches(start = false, fixed = true) = h <= 0;
equation
  der(h) = v;
  der(v) = -9.81;
  when touches then
    reinit(v, -0.8*pre(v));
  end when;
end Ball;

//@ case long_results
//@ used by results.rs
model Long
  Real x(start = 1, fixed = true);
  Real v(start = 0, fixed = true);
equation
  der(x) = v;
  der(v) = -x;
  annotation(experiment(StopTime = 1e6, Interval = 1));
end Long;

//@ case condition_before_assignment
// A section starts with the values from before the event, so the second condition reads what `high` was:
// with its new value, true would make it false and false would make it true.
model Latch
  Real x = sin(6*time);
  Boolean high(start = false, fixed = true);
  Integer n(start = 0, fixed = true);
algorithm
  when x > 0.5 then
    high := true;
    n := pre(n) + 1;
  elsewhen x < 0.5 and high then
    high := false;
    n := pre(n) + 10;
  end when;
  annotation(experiment(StopTime = 3));
end Latch;
//@ expect events "x > 0.5 became true" = 3 at (asin(0.5) + 2*acos(-1)*(k - 1))/6 rel 1e-6
//@ expect n = 33
//@ expect n at 0.4, 0.5 = 1, 11

//@ case when_equations_without_solution
// At the same event, `y` is not `z` and `z` is `y`.
model Contradiction
  Boolean y(start = false, fixed = true), z(start = false, fixed = true);
equation
  //@ error[MO0905] 3-
  when sample(0.1, 0.1) then
    y = not z;
  end when;
  when sample(0.1, 0.1) then
    z = y;
  end when;
end Contradiction;
//@ status 3

//@ case when_equation_of_itself
model Count
  Integer y(start = 0, fixed = true);
equation
  //@ error[MO0905] 3-
  when sample(0.1, 0.1) then
    y = y + 1;
  end when;
end Count;
//@ status 3

//@ case when_equations_that_refer_to_each_other
// These have one solution: z = 1, y = 2.
model Solvable
  Integer y(start = 0, fixed = true), z(start = 5, fixed = true);
equation
  when sample(0.1, 0.1) then
    y = z + 1;
  end when;
  when sample(0.1, 0.1) then
    z = if y > 3 then 0 else 1;
  end when;
end Solvable;
//@ expect y, z = 2, 1

//@ case terminate_under_a_condition
model Until
  Integer n(start = 0, fixed = true);
equation
  when sample(0.1, 0.1) then
    n = pre(n) + 1;
    if n >= 3 then
      terminate("enough");
    end if;
  end when;
end Until;
//@ expect n = 3
//@ expect time = 0.3 abs 1e-12

//@ case rounded_time_at_the_event_of_a_clock
// The event is described by the function that rounds, although its value depends on the one before.
model Rounded
  Real v = floor(time), u = ceil(time - 0.5);
  discrete Real x(start = 0, fixed = true);
equation
  when sample(1, 1) then
    x = pre(x) + v;
  end when;
  annotation(experiment(StopTime = 3.2));
end Rounded;
//@ expect x = 1 + 2 + 3
//@ expect v, u = 3, 3

//@ case shift_register
//@ run stop=1
// A chain of 150 variables, each of which waits for `pre` of the one before, takes as many passes of one event iteration.
model ShiftRegister
  Boolean b[150](each start = false, each fixed = true);
equation
  b[1] = time > 0.5;
  for i in 2:150 loop
    b[i] = pre(b[i - 1]);
  end for;
end ShiftRegister;
//@ expect b[150] at 0.4, 1 = 0, 1

//@ case ticks_that_coincide_stay_together
// Rounding puts the time event up to some 1e-14 s beside the ticks, which coincide with each other at each third one.
model Ticks
  Integer n(start = 0, fixed = true);
  Integer k(start = 0, fixed = true);
  Integer apart(start = 0, fixed = true);
  discrete Real next(start = 0.3, fixed = true);
equation
  when sample(0, 0.1) then
    n = pre(n) + 1;
  end when;
  when sample(0, 0.3) then
    k = pre(k) + 1;
    apart = pre(apart) + (if n == 3*(k - 1) + 1 then 0 else 1);
  end when;
  when time >= pre(next) then
    next = pre(next) + 0.3;
  end when;
  annotation(experiment(StopTime = 100));
end Ticks;
//@ expect n, k, apart = 1001, 334, 0
