//@ case finite_escape
//@ run method=radau
//@ status 3
model Escape
  //@ error[MO0909] 8
  Real x(start = 1, fixed = true);
equation
  der(x) = x^2;
  annotation(experiment(StopTime = 2));
end Escape;

// Pulses, crossings and bounces that fit between the steps: each integral and each number of events
// is that of the closed form.

//@ case narrow_pulse
// The integral of a normalized Gaussian of width 1e-4 is 1.
//@ run
model Pulse
  Real x(start = 0, fixed = true);
equation
  der(x) = exp(-((time - 0.5)/1e-4)^2)/(1e-4*sqrt(acos(-1.0)));
end Pulse;
//@ expect x = 1 abs 1e-6
//@ expect x at 0.49 = 0 abs 1e-9
//@ run method=radau
//@ expect x = 1 abs 1e-6
//@ run method=bdf
//@ expect x = 1 abs 1e-5
//@ run method=dopri
//@ expect x = 1 abs 1e-6

//@ case pulses_by_other_functions
// Their integrals are the area of a triangle, the arctangent, and the hyperbolic tangent.
model Pulses
  constant Real w = 1e-4;
  Real triangle(start = 0, fixed = true);
  Real lorentz(start = 0, fixed = true);
  Real sech(start = 0, fixed = true);
  Real shift = time - 0.3;
equation
  der(triangle) = max(0, 1 - abs(time - 0.7123)/w)/w;
  der(lorentz) = 1/(w*(1 + (shift/w)^2));
  der(sech) = 1/(w*cosh((time - 0.5)/w*0.01)^2)*0.01;
end Pulses;
//@ expect triangle = 1 abs 1e-5
//@ expect lorentz = atan(0.7/1e-4) + atan(0.3/1e-4) abs 1e-5
//@ expect sech = 2*tanh(50) abs 1e-5

//@ case pulse_without_events
// `noEvent` turns the comparisons into jumps that are no events; the steps find them all the same.
model Window
  Real x(start = 0, fixed = true);
equation
  der(x) = noEvent(if time > 0.41 and time < 0.4101 then 1e4 else 0);
end Window;
//@ expect x = 1 abs 1e-5

//@ case pulse_of_a_parameter
//@ run set=instant=0.123
model Shifted
  parameter Real instant = 0.9;
  Real x(start = 0, fixed = true);
equation
  der(x) = 1e3*exp(-((time - instant)*1e3)^2);
end Shifted;
//@ expect x = sqrt(acos(-1)) abs 1e-5
//@ expect x at 0.12 = 0 abs 0.01

//@ case two_crossings_in_a_step
model Window
  Real x(start = 0, fixed = true);
  discrete Integer n(start = 0, fixed = true);
equation
  der(x) = 1;
  when abs(x - 0.5) < 1e-5 then
    n = pre(n) + 1;
  end when;
end Window;
//@ expect n = 1
//@ expect events "became true" = 1 at 0.49999 abs 1e-9
//@ run method=bdf
//@ expect n = 1
//@ run method=dopri
//@ expect n = 1

//@ case touching_parabola
// x = (time - 0.5)^2: below 1e-9 for sqrt(1e-9) on either side.
model Parabola
  Real x(start = 0.25, fixed = true);
  Real v(start = -1, fixed = true);
  discrete Integer n(start = 0, fixed = true);
equation
  der(x) = v;
  der(v) = 2;
  when x <= 1e-9 then
    n = pre(n) + 1;
  end when;
end Parabola;
//@ expect n = 1
//@ expect events "became true" = 1 at 0.5 - sqrt(1e-9) abs 1e-7

//@ case grazing_sine
//@ run stop=2
model Sine
  Real x(start = 0, fixed = true);
  Real v(start = 1, fixed = true);
  discrete Integer n(start = 0, fixed = true);
  discrete Integer m(start = 0, fixed = true);
equation
  der(x) = v;
  der(v) = -x;
  when x >= 1 - 1e-6 then
    n = pre(n) + 1;
  end when;
  when sin(time) >= 1 - 1e-9 then
    m = pre(m) + 1;
  end when;
end Sine;
//@ expect n, m = 1, 1

//@ case fast_source_against_a_state
// sin(1e4 t) crosses t/2 twice in each of the 1e4/(2*pi) = 1591.55 periods; at the end, where t/2 is
// 0.5, the second crossing is at 5/12 of a period, before the end of the last one.
model Comparator
  Real x(start = 0, fixed = true);
  Boolean above = sin(1e4*time) > x;
equation
  der(x) = 0.5;
end Comparator;
//@ expect events "sin" = 3184

//@ case ball_falls_through
//@ run stop=10
//@ status 3
model Ball
  Real h(start = 1, fixed = true);
  Real v(start = 0, fixed = true);
equation
  der(h) = v;
  der(v) = -9.81;
  //@ error[MO0932] 3-
  when h <= 0 then
    reinit(v, -0.5*pre(v));
  end when;
end Ball;

//@ case two_balls_that_bounce_little
// After four bounces the ball rises by (0.1^4 sqrt(2 g))^2/(2 g) = 1e-8 m, and the next time by less than
// rounding errors.
//@ run stop=10
//@ status 3
model Balls
  Real h(start = 1, fixed = true), v(start = 0, fixed = true);
  Real h2(start = 1.3, fixed = true), v2(start = 0, fixed = true);
equation
  der(h) = v;
  der(v) = -9.81;
  der(h2) = v2;
  der(v2) = -9.81;
  //@ error[MO0932] 3-
  when h <= 0 then
    reinit(v, -0.1*pre(v));
  end when;
  when h2 <= 0 then
    reinit(v2, -0.1*pre(v2));
  end when;
end Balls;

//@ case ball_that_the_floor_does_not_hold
// Without a bounce the equations say that it falls on.
//@ run stop=1
model Ball
  Real h(start = 1, fixed = true);
  Real v(start = 0, fixed = true);
equation
  der(h) = v;
  der(v) = -9.81;
  when h <= 0 then
    reinit(v, 0);
  end when;
end Ball;
//@ expect h = -1.47555 abs 1e-3

//@ case ball_comes_to_rest
// The bounces end at sqrt(2/g) (1 + e)/(1 - e) = 1.3546 s.
//@ run stop=10
model Ball
  Real h(start = 1, fixed = true);
  Real v(start = 0, fixed = true);
  Boolean flies(start = true, fixed = true);
equation
  der(h) = v;
  der(v) = if flies then -9.81 else 0;
  when h <= 0 then
    flies = abs(pre(v)) > 1e-3;
    reinit(v, if abs(pre(v)) > 1e-3 then -0.5*pre(v) else 0);
  end when;
end Ball;
//@ expect h, v = 0, 0 abs 1e-9
//@ expect flies at 1.353, 1.36 = 1, 0

//@ case relation_faster_than_the_steps
// 318 changes in a second; steps of up to 0.02 s see other ones, so the run says so.
model Fast
  Integer n(start = 0, fixed = true);
  Real x(start = 0, fixed = true);
equation
  der(x) = 1;
  //@ warning[MO0936] 3-
  when sin(1000*x) > 0 then
    n = pre(n) + 1;
  end when;
end Fast;
//@ expect x = 1 abs 1e-9

//@ case relation_far_faster_than_the_steps
// Steps of many periods: the samples in them look calm, the slope at their start does not.
model FarFaster
  Integer n(start = 0, fixed = true);
  Real x(start = 0, fixed = true);
equation
  der(x) = 1;
  //@ warning[MO0936] 3-
  when sin(1e5*x) > 0 then
    n = pre(n) + 1;
  end when;
end FarFaster;
//@ expect x = 1 abs 1e-9

//@ case relation_as_fast_as_the_steps
// With steps that resolve it, all are found.
//@ run interval=0.001
model AsFast
  Integer n(start = 0, fixed = true);
  Real x(start = 0, fixed = true);
equation
  der(x) = 1;
  when sin(100*x) > 0 then
    n = pre(n) + 1;
  end when;
end AsFast;
//@ expect n = 16

//@ case limit_that_is_left_after_many_resets
// The state is set back whenever it begins to fall above its limit; the resets accumulate where the input passes the
// limit. From there on the state is below it, and nothing sets it back.
model Limited
  parameter Real T = 0.05;
  parameter Real most = 0.5;
  Real u = 1.2 - time;
  Real x(start = 0.5, fixed = true);
equation
  T*der(x) = u - x;
  when x > most and u - x < 0 then
    reinit(x, most);
  end when;
end Limited;
//@ run stop=1 tolerance=1e-8
// A lag behind a ramp that begins at 0.7 s.
//@ expect x = 0.2 + 0.05*(1 - exp(-0.3/0.05)) abs 1e-6
//@ expect each x < u + 0.05 where time > 0.7

//@ case rectified_sine
// A thousand periods: the half wave has the mean 1/pi.
model Rectified
  Real x(start = 0, fixed = true);
  Real y(start = 0, fixed = true);
  Real z(start = 0, fixed = true);
equation
  der(x) = max(0, sin(2*3.141592653589793*50*time));
  der(y) = abs(cos(2*3.141592653589793*50*time));
  der(z) = noEvent(if sin(2*3.141592653589793*50*time) > 0 then 1 else 0);
end Rectified;
//@ run stop=20
//@ expect x = 20/pi rel 1e-5
//@ expect y = 40/pi rel 1e-5
//@ expect z = 10 rel 1e-3
//@ run stop=20 method=radau
//@ expect x = 20/pi rel 1e-5
//@ run stop=20 method=bdf tolerance=1e-7
//@ expect x = 20/pi rel 1e-4
//@ run stop=2
//@ expect x = 2/pi rel 1e-5

//@ case many_smooth_pulses
// The integral over a period is the central binomial coefficient of 200 over 2^200, times the period.
model Pulses
  Real z(start = 0, fixed = true);
equation
  der(z) = cos(3.141592653589793*time)^200;
end Pulses;
//@ let factor(n) = if n < 1 then 1 else (2*n - 1)/(2*n)*factor(n - 1)
//@ run stop=1000 tolerance=1e-8
//@ expect z = 1000*factor(100) rel 1e-4
//@ run stop=10
//@ expect z = 10*factor(100) rel 1e-4

//@ case pulses_after_events
// The pulses are narrower than a five-hundredth of the time between the events that `mod` causes.
model Train
  Real s = exp(-((mod(time, 0.5) - 0.25)/1e-3)^2);
  Real x(start = 0, fixed = true);
  Integer n(start = 0, fixed = true);
equation
  der(x) = s;
  when s > 0.4 then
    n = pre(n) + 1;
  end when;
end Train;
//@ run stop=10
//@ expect x = 20*1e-3*sqrt(pi) rel 1e-4
//@ expect n = 20
//@ run stop=100 method=radau
//@ expect x = 200*1e-3*sqrt(pi) rel 1e-4
//@ expect n = 200

//@ case pulse_after_a_discrete_instant
model Fired
  discrete Real fired(start = -1, fixed = true);
  Real s = exp(-((time - fired - 0.3)/1e-3)^2);
  Real x(start = 0, fixed = true);
equation
  der(x) = s;
  when sample(1, 2) then
    fired = time;
  end when;
end Fired;
//@ run stop=8
//@ expect x = 4*1e-3*sqrt(pi) rel 1e-4

//@ case many_narrow_pulses
// Two pulses a period of the sine.
model Narrow
  Real c = exp(-(sin(6.283185307179586*time + 1)/1e-3)^2);
  Integer m(start = 0, fixed = true);
equation
  when c > 0.4 then
    m = pre(m) + 1;
  end when;
end Narrow;
//@ run stop=10
//@ expect m = 20
//@ run stop=1000
//@ expect m = 2000

//@ case fast_burst_in_a_long_run
// 100 Hz for five seconds, in a run of 3 h.
model Burst
  Integer n(start = 0, fixed = true);
  Real s = if time < 5 then sin(2*3.141592653589793*100*time + 0.5) else 0.3;
equation
  when s > 0.4 then
    n = pre(n) + 1;
  end when;
end Burst;
//@ run stop=10000
//@ expect n = 500

//@ case pulses_of_both_kinds
// Next to events, points are so close that rounding looks like a fast oscillation; it must not refine the grid.
model Both
  Integer n(start = 0, fixed = true), m(start = 0, fixed = true);
  Real s = exp(-((mod(time, 0.5) - 0.25)/1e-4)^2);
  Real c = exp(-(sin(6.283185307179586*time + 1)/1e-3)^2);
equation
  when s > 0.4 then
    n = pre(n) + 1;
  end when;
  when c > 0.4 then
    m = pre(m) + 1;
  end when;
end Both;
//@ run stop=200
//@ expect n, m = 400

//@ case fast_source_far_from_zero
// The sine is fast for the steps, and times are a million times as long as the run.
model Late
  Integer n(start = 0, fixed = true);
  Real x(start = 0.5, fixed = true);
equation
  der(x) = 0;
  when sin(2*3.141592653589793*50*(time - 1e6)) > x then
    n = pre(n) + 1;
  end when;
  annotation(experiment(StartTime = 1e6, StopTime = 1000001));
end Late;
//@ expect n = 50

//@ case an_argument_that_jumps
// The argument of a sine that jumps at an event is no oscillation that a grid of a million points resolves.
model Jump
  function switched
    input Real x;
    input Integer n;
    output Real w[3];
  protected
    Real b;
  algorithm
    w := {1, 2, 3};
    b := abs(sin(if x > 1 then n else x));
    if b > 0.1 then
      w[1 + mod(n, 3)] := x;
    end if;
  end switched;
  Integer n = integer(4.01*time) + 3;
  Real w[3] = switched(2*time, n);
  annotation(experiment(StopTime = 1));
end Jump;
//@ expect w[1] at 0.25, 0.9 = 1, 1.8
//@ expect w[2] at 0.25, 0.9 = 0.5, 2
