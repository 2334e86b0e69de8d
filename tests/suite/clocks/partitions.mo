//@ case sampled_and_held
//@ run stop=1 interval=0.05 tolerance=1e-9
// A linear equation is solved for its variable; the plant sees the held value.
model Loop
  Real x(start = 1, fixed = true);
  Real y, s(start = 0), u;
  Real held;
equation
  der(x) = held - x;
  y = sample(x, Clock(1, 10));
  s = previous(s) + y;
  3*u + s = 5;
  held = hold(u);
end Loop;
//@ let x1 = 4/3 + (1 - 4/3)*exp(-0.1)
//@ expect y at 0.09, 0.11 = 1, x1 abs 1e-8
//@ expect s at 0.09, 0.11 = 1, 1 + x1 abs 1e-8
//@ expect held at 0.09, 0.11 = 4/3, (5 - 1 - x1)/3 abs 1e-8
//@ expect x at 0.1 = x1 abs 1e-8

//@ case left_limit
//@ run stop=1
// The example of section 16.5.1: the plant is initialized before the first tick.
model LeftLimit
  Real y(start = 1), yc;
initial equation
  der(y) = 0;
equation
  der(y) + y = 2;
  yc = sample(y, Clock(0.1));
end LeftLimit;
//@ expect yc = 2 abs 1e-9

//@ case derived_clocks
//@ run stop=1.95 interval=0.01
// The clocks of the examples in section 16.5.2, with periods that no float represents.
model Derived
  Clock u = Clock(3, 10);
  Clock y1 = shiftSample(u, 1, 3);
  Clock y2 = backSample(y1, 1, 3);
  Clock y3 = shiftSample(u, 3);
  Clock y4 = backSample(y3, 2);
  Integer a(start = 0), b(start = 0), c(start = 0), d(start = 0), e(start = 0);
  Integer fast, slow, passed;
  Integer half = subSample(a, 2);
  Real step, stepOfFast = interval(fast);
  Boolean begins;
equation
  when u then
    a = previous(a) + 1;
    step = interval();
    begins = firstTick();
  end when;
  when y1 then
    b = previous(b) + 1;
    passed = shiftSample(a, 1, 3);
  end when;
  when y2 then
    c = previous(c) + 1;
  end when;
  when y3 then
    d = previous(d) + 1;
  end when;
  when y4 then
    e = previous(e) + 1;
  end when;
  fast = superSample(a, 3);
  slow = subSample(fast, 6);
end Derived;
//@ expect a at 0.29, 0.31, 0.61, 1.79, 1.81 = 1, 2, 3, 6, 7
//@ expect b at 0.09, 0.11, 0.39, 0.41 = 0, 1, 1, 2
//@ expect c at 0.29, 0.31 = 1, 2
//@ expect d at 0.89, 0.91, 1.19, 1.21 = 0, 1, 1, 2
//@ expect e at 0.29, 0.31, 0.59, 0.61 = 0, 1, 1, 2
//@ expect passed at 0.41, 0.69, 0.71 = 2, 2, 3
//@ expect half at 0.31, 0.61, 1.21 = 1, 3, 5
//@ expect slow at 0.31, 0.61, 1.21 = 1, 3, 5
//@ expect step, stepOfFast = 0.3, 0.1 rel 1e-15
//@ expect begins at 0.29, 0.31 = 1, 0

//@ case last_and_left
//@ run stop=1 interval=0.01
// The model `NoClockVsSampleHold` of section 16.5.2.
model NoClockVsSampleHold
  Clock clk1 = Clock(0.1);
  Clock clk2 = subSample(clk1, 2);
  Real x(start = 0), y(start = 0), z(start = 0);
equation
  when clk1 then
    x = previous(x) + 0.1;
  end when;
  when clk2 then
    y = noClock(x);
    z = sample(hold(x));
  end when;
end NoClockVsSampleHold;
//@ expect y at 0.19, 0.21, 0.41 = 0.1, 0.3, 0.5 abs 1e-12
//@ expect z at 0.19, 0.21, 0.41 = 0, 0.2, 0.4 abs 1e-12

//@ case varying_interval
//@ run stop=0.02
// The example of section 16.3: ticks at 0, 0.003, 0.007, 0.012, 0.018.
model Varying
  Integer nextInterval(start = 2);
  Real y(start = 0), at, step;
equation
  when Clock(nextInterval, 1000) then
    nextInterval = previous(nextInterval) + 1;
    y = previous(y) + 1;
    at = sample(time);
    step = interval();
  end when;
end Varying;
//@ expect y at 0.0029, 0.0031, 0.0069, 0.0071, 0.0121 = 1, 2, 2, 3, 4
//@ expect at at 0.0031, 0.0071, 0.0121, 0.0181 = 0.003, 0.007, 0.012, 0.018 abs 1e-12
//@ expect step at 0.0001, 0.0031, 0.0071 = 0.002, 0.003, 0.004 abs 1e-12

//@ case event_clock
//@ run stop=3 tolerance=1e-10
model OnEvents
  Integer n(start = 0), every(start = 0), late(start = 0);
  Real at, step;
equation
  when Clock(sin(10*time) > 0.5, 0.3) then
    n = previous(n) + 1;
    at = sample(time);
    step = interval();
  end when;
  every = subSample(n, 2);
  late = shiftSample(n, 1);
end OnEvents;
//@ let turn = pi/5
//@ expect n at 0.05, 0.06, 0.68, 0.69 = 0, 1, 1, 2
//@ expect at at 0.06, 0.69 = pi/60, pi/60 + turn abs 1e-7
//@ expect step at 0.06, 0.69 = 0.3, turn abs 1e-7
//@ expect every at 0.06, 0.69, 1.4 = 1, 1, 3
//@ expect late at 0.06, 0.69, 1.4 = 0, 2, 3

//@ case inferred_factors
//@ run stop=1 interval=0.01
model Inferred
  Real y = sample(time, Clock(1, 50));
  Real z = subSample(y);
  Real w(start = 0);
equation
  when Clock(1, 10) then
    w = z;
  end when;
end Inferred;
//@ expect z at 0.095, 0.105, 0.195 = 0, 0.1, 0.1 abs 1e-12

//@ case equations_together
//@ run stop=1 interval=0.1
// Two equations that only together determine two variables, one of them not linear.
model Together
  Real u = sample(time, Clock(1, 10));
  Real a(start = 1), b(start = 1);
equation
  a*b = 2 + u;
  a - b = 1;
end Together;
//@ expect a = (1 + sqrt(1 + 4*3))/2 abs 1e-9
//@ expect b at 0.51 = (-1 + sqrt(1 + 4*2.5))/2 abs 1e-9

//@ case parameter_period
//@ run stop=1 set=T=0.25
// The period stays a parameter that can be set.
model Period
  parameter Real T = 0.1;
  Clock c = Clock(T);
  Integer n(start = 0);
equation
  when c then
    n = previous(n) + 1;
  end when;
end Period;
//@ expect n at 0.24, 0.26, 0.99 = 1, 2, 4

//@ case algorithm
//@ run stop=1 interval=0.1
model Algorithms
  Clock c = Clock(0.25);
  Integer u(start = 0), n(start = 0), twice;
equation
  when c then
    u = previous(u) + 1;
  end when;
algorithm
  n := previous(n);
  for k in 1:2 loop
    n := n + u;
  end for;
  twice := 2*n;
end Algorithms;
//@ expect n at 0.1, 0.3, 0.6 = 2, 6, 12
//@ expect twice at 0.6 = 24

//@ case equations_of_one_clause
//@ run stop=1 interval=0.05
// `uu = u` alone says at which clock the other equation of the clause is evaluated.
model Toggle
  Real u, uu;
  Boolean on(start = false), held;
equation
  u = sample(time, Clock(2, 10));
  when Clock() then
    uu = u;
    on = not previous(on);
  end when;
  held = hold(on);
end Toggle;
//@ expect held at 0.1, 0.3, 0.5, 0.7 = 1, 0, 1, 0
