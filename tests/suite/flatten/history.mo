//@ case spatial_distribution
//@ snapshot flat
// Transport along a line, there and back, and a delay that changes.
model Carried
  Real x(start = 0, fixed = true) "how far everything has moved";
  Real v = 0.4*cos(time);
  Real left = 10 + time;
  Real right = -time;
  Real at_left;
  Real at_right;
  Real T = 0.5 + 0.25*sin(2*time);
  Real step = if time < 1 then 0 else 1 + time;
  Real late = delay(step, T, 1);
  Real slow = delay(sin(5*time), T, 1);
equation
  der(x) = v;
  (at_left, at_right) = spatialDistribution(left, right, x, v >= 0, {0, 0.5, 0.5, 1}, {0, 1, 3, 4});
end Carried;
//@ expect flat has 2 "delay("
//@ expect flat has 2 "spatialDistribution("
// By characteristics: what began on the line; what came in by the same end at pi - t; what began
// there again; what came in by this end at 3 pi - t.
//@ run stop=1 tolerance=1e-9 also=flat
//@ expect at_right = 4 - 0.8*sin(1) abs 2e-6
//@ run stop=3 tolerance=1e-9 also=flat
//@ expect at_left = 10 + pi - 3 abs 2e-6
//@ run stop=4 tolerance=1e-9 also=flat
//@ expect at_left = -0.8*sin(4) abs 2e-6
//@ run stop=6 tolerance=1e-9 also=flat
//@ expect at_right = 6 - 3*pi abs 2e-6
//@ let then = 2 - 0.5 - 0.25*sin(4)
//@ run stop=2 tolerance=1e-9 also=flat
//@ expect late = 1 + then abs 2e-6
//@ expect slow = sin(5*then) abs 2e-6
// Before the jump has come.
//@ run stop=1.5 tolerance=1e-9 also=flat
//@ expect late = 0

//@ case delay
//@ run stop=2 tolerance=1e-9
//@ snapshot flat
// Delayed values of a smooth signal, of a jump, and around a loop.
model Delays
  parameter Real T = 0.3;
  Real x(start = 1, fixed = true);
  Real late = delay(sin(time), T);
  Real step = if time < 1 then 0 else 2;
  Real later = delay(step, T);
  Real sum(start = 0, fixed = true);
equation
  // x' = -x(t - 1) with x = 1 before: by the method of steps 1 - t, and then t^2/2 - 2 t + 3/2.
  der(x) = -delay(x, 1.0);
  der(sum) = later;
end Delays;
//@ expect flat has 3 "delay("
//@ expect late = sin(1.7) abs 1e-6
// The method of steps: t^2/2 - 2 t + 3/2 from 1 to 2. The jump to 2 comes out at 1.3.
//@ expect x = -0.5 abs 1e-8
//@ expect sum = 1.4 abs 1e-8

//@ case a_delay_that_initialization_determines
model Belt
  parameter Real length = 0.4;
  parameter Real tau(fixed = false, start = 1);
  Real x = time;
  Real y = delay(x, tau);
initial equation
  2*tau = length;
end Belt;
//@ run stop=1 interval=0.1
//@ expect y = 0.8 rel 1e-6

//@ case delay_of_a_sign
//@ run stop=1 tolerance=1e-9
// `sign` is an Integer that makes no event; so is what a function gives.
model Delayed
  function step
    input Real u;
    output Integer y = if u > 0 then 1 else 0;
  end step;
  Real v = time - 0.5;
  Real s = delay(sign(v), 0.1);
  Real a = delay(step(v), 0.3);
  Real b = delay(noEvent(if time > 0.5 then 1 else 0), 0.3);
end Delayed;
//@ expect s at 0.55, 0.65 = -1, 1
//@ expect a at 0.75, 0.85 = 0, 1
//@ expect b at 0.75, 0.85 = 0, 1

//@ case delayed_value_that_depends_on_itself
//@ run stop=1 tolerance=1e-9
// Before the start, a delayed value is that at the start: y = 1 + 3 y, z = 1 + 0.9 z, w = cos(w), q = 1 - 0.5 q.
model Echoes
  Real y = 1 + 3*delay(y, 0.5);
  Real z = 1 + 0.9*delay(z, 0.5);
  Real w = cos(delay(w, 0.5));
  Real q = x - 0.5*delay(q, 0.1);
  Real x(start = 1, fixed = true);
equation
  der(x) = -q;
end Echoes;
//@ expect y, z = -0.5, 10 abs 1e-9
//@ expect w = 0.7390851332151607 abs 1e-9
//@ expect q at start = 2/3 abs 1e-9

//@ case delayed_value_without_a_start
//@ run stop=1
model Echo
  //@ error[MO0948] 16-28
  Real y = 1 + delay(y, 0.5);
end Echo;
//@ status 3

//@ case expressions_faster_than_the_states_are_delayed
//@ run stop=3 tolerance=1e-6
// Until 1 s nothing that a state integrates changes fast, so steps are long; the delayed expression has 160 periods in each.
model Fast
  Real u = sin(1000*time);
  Real du = delay(u, 1);
  Real y(start = 0, fixed = true);
equation
  der(y) = du - y;
end Fast;
//@ expect each du = sin(1000*(time - 1)) where time >= 1 abs 1e-4

//@ case delayed_corners_stay_corners
//@ run stop=3 tolerance=1e-8 interval=0.001
// A triangle wave has corners at its events, which no polynomial goes across.
model Corners
  Real u(start = 0, fixed = true);
  discrete Real slope(start = 1, fixed = true);
  Real du = delay(u, 1);
equation
  der(u) = slope;
  when sample(0.25, 0.5) then
    slope = -pre(slope);
  end when;
end Corners;
//@ let wave(t) = 2/(2*3.141592653589793)*asin(sin(2*3.141592653589793*t))/2
//@ expect each du = wave(time - 1) where time >= 1 abs 1e-7

//@ case steps_much_shorter_than_the_delay
//@ run stop=2.5 interval=0.01237
// Rows between events read the history of the step that has just ended.
model Short
  Real u(start = 0, fixed = true);
  Real du = delay(u, 1);
  Boolean p(start = false, fixed = true);
equation
  der(u) = 1;
  when sample(0, 4e-4) then
    p = not pre(p);
  end when;
end Short;
//@ expect each du = time - 1 where time >= 1 abs 1e-9
