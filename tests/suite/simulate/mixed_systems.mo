//@ case dry_friction_between_two_bodies
// Two bodies with dry friction between them. The force that holds them together is known only where
// they are held: from sliding no repetition leads there.
model Contact
  parameter Real F = 3;
  parameter Real c = 4;
  Real v1(start = -1, fixed = true);
  Real v2(start = 0, fixed = true);
  Real w = v1 - v2;
  Real a_rel = der(v1) - der(v2);
  Real s;
  Real f;
  Boolean up(start = false, fixed = true);
  Boolean down(start = false, fixed = true);
  Boolean stuck;
  Integer mode(start = -1, fixed = true);
equation
  up = pre(mode) == 0 and s > c;
  down = pre(mode) == 0 and s < -c;
  stuck = not (pre(mode) == 1 or up or pre(mode) == -1 or down);
  a_rel = if stuck then 0 elseif up or pre(mode) == 1 then s - c else s + c;
  f = if stuck then s elseif up or pre(mode) == 1 then c else -c;
  mode = if (pre(mode) == 1 or up) and w > 0 then 1
    elseif (pre(mode) == -1 or down) and w < 0 then -1 else 0;
  der(v1) = F - f;
  10*der(v2) = f;
  annotation(experiment(StopTime = 1, Tolerance = 1e-9));
end Contact;
// They slide until -1 + (F + c) t = -c/10 t, and then go together, by F/11.
//@ run
//@ let met = 1/7.4
//@ expect v1, v2 = -0.4*met + 3/11*(1 - met) rel 1e-8
//@ expect mode = 0
// A stronger pull tears them apart: F - c forwards on the one, c/10 on the other.
//@ run set=F=8
//@ let torn = 1/12.4
//@ expect v2 = -0.4*torn + 0.4*(1 - torn) rel 1e-8
//@ expect v1 = -0.4*torn + 4*(1 - torn) rel 1e-8
//@ expect mode = 1

//@ case multivibrator
// An amplifier that feeds back to itself leaves each limit where it ceases to be a solution, and jumps to
// the other: between two jumps the capacitor goes from one threshold to the other.
model Multivibrator
  parameter Real V0 = 15000;
  parameter Real tau = 0.1/(2*log(3));
  Real v(start = 1, fixed = true);
  Real w(start = 10);
  Real plus;
  Real u;
equation
  w = plus - v;
  plus = u - plus;
  u = smooth(0, noEvent(if V0*w > 15 then 15 elseif V0*w < -15 then -15 else V0*w));
  tau*der(v) = u - v;
  annotation(experiment(StopTime = 1, Tolerance = 1e-8));
end Multivibrator;
// The linear part of the amplifier shifts the thresholds by 15/V0.
//@ let tau = 0.1/(2*log(3))
//@ let threshold = 7.5 - 15/15000
//@ let first = tau*log(14/(15 - threshold))
//@ let half = tau*log((15 + threshold)/(15 - threshold))
//@ let jumps = floor((time - first)/half)
//@ let since = (time - first)/half - jumps
// In the middle between two jumps.
//@ expect each u = if mod(jumps, 2) == 0 then -15 else 15 where time > first and since > 0.01 and since < 0.99
//@ let last = first + 19*half
//@ expect v = 15 - (15 + threshold)*exp(-(1 - last)/tau) abs 1e-2

//@ case clutch
//@ run stop=6 tolerance=1e-9
// Otter, Elmqvist, Mattsson (1999): locked and sliding phases of dry friction as one set of equations
// over the curve parameter `sa`. Slip 10 rad/s is braked at 3 + 3 rad/s2 from 0.5 s on; the two
// inertias lock, turn together, and slip again when the pressure is taken away at 4 s.
model Clutch
  parameter Real J = 1;
  Real w1(start = 10, fixed = true);
  Real w2(start = 0, fixed = true);
  Real tau;
  Real drive = if time < 4 then 0 else 1;
  Real tau_max = if time < 0.5 then 0 elseif time < 4 then 3 else 0.2;
  Real slip = w1 - w2;
  Real sa;
  Integer mode(start = 1, fixed = true);
  Boolean forward = pre(mode) == 0 and sa > tau_max;
  Boolean backward = pre(mode) == 0 and sa < -tau_max;
  Boolean locked = pre(mode) == 0 and not (forward or backward);
equation
  J*der(w1) = drive - tau;
  J*der(w2) = tau;
  der(slip) = if locked then 0 elseif forward then sa - tau_max
    elseif backward then sa + tau_max else sa;
  tau = if locked then sa elseif forward then tau_max elseif backward then -tau_max
    else mode*tau_max;
  mode = if (pre(mode) == 1 or forward) and slip > 0 then 1
    elseif (pre(mode) == -1 or backward) and slip < 0 then -1 else 0;
end Clutch;
//@ let lock = 0.5 + 10/6
//@ let first(t) = if t < 0.5 then 10 else if t < lock then 10 - 3*(t - 0.5) else if t < 4 then 5 else 5 + 0.8*(t - 4)
//@ let second(t) = if t < 0.5 then 0 else if t < lock then 3*(t - 0.5) else if t < 4 then 5 else 5 + 0.2*(t - 4)
//@ expect each w1 = first(time) abs 1e-7
//@ expect each w2 = second(time) abs 1e-7
//@ expect events < 12

//@ case friction_sticks_below_the_breakaway_force
//@ run stop=2 interval=0.05 tolerance=1e-9
// When the speed comes to zero, the drive of 2.5 exceeds the sliding friction of 2, not the breakaway force of 3: both to
// slide on and to stick solve the equations of that instant, and the body sticks.
model Friction
  Real w(start = -1, fixed = true);
  Real a;
  Real sa;
  Real f;
  Boolean forward(start = false, fixed = true);
  Boolean backward(start = false, fixed = true);
  Boolean locked;
  Integer mode(start = -1, fixed = true);
equation
  der(w) = a;
  0.5*a = 2.5 - f;
  forward = pre(mode) == 0 and sa > 3;
  backward = pre(mode) == 0 and sa < -3;
  locked = not (pre(mode) == 1 or forward or pre(mode) == -1 or backward);
  a = if locked then 0 elseif forward then sa - 3 elseif backward then sa + 3
    elseif pre(mode) == 1 then sa - 3 else sa + 3;
  f = if locked then sa elseif forward then 2 elseif backward then -2 elseif pre(mode) == 1 then 2 else -2;
  mode = if (pre(mode) == 1 or forward) and w > 0 then 1
    elseif (pre(mode) == -1 or backward) and w < 0 then -1 else 0;
end Friction;
//@ expect w at 0.05, 0.1 = -0.55, -0.1 abs 1e-9
//@ expect w at 0.2, 1, 2 = 0, 0, 0 abs 1e-9
//@ expect locked at 0.1, 0.2, 2 = 0, 1, 1

//@ case friction_breaks_away
//@ run stop=4 interval=0.02 tolerance=1e-9
// From rest under 4 sin(2 t): it breaks away at 3, slides, sticks, and breaks away backwards at -3.
model Drive
  Real w(start = 0, fixed = true);
  Real a;
  Real sa;
  Real f;
  Boolean forward(start = false, fixed = true);
  Boolean backward(start = false, fixed = true);
  Boolean locked;
  Integer mode(start = 0, fixed = true);
equation
  der(w) = a;
  0.5*a = 4*sin(2*time) - f;
  forward = pre(mode) == 0 and (sa > 3 or pre(forward) and sa > 2);
  backward = pre(mode) == 0 and (sa < -3 or pre(backward) and sa < -2);
  locked = not (pre(mode) == 1 or forward or pre(mode) == -1 or backward);
  a = if locked then 0 elseif forward then sa - 3 elseif backward then sa + 3
    elseif pre(mode) == 1 then sa - 3 else sa + 3;
  f = if locked then sa elseif forward then 2 elseif backward then -2 elseif pre(mode) == 1 then 2 else -2;
  mode = if (pre(mode) == 1 or forward) and w > 0 then 1
    elseif (pre(mode) == -1 or backward) and w < 0 then -1 else 0;
end Drive;
//@ let away = asin(0.75)/2
//@ let back = (3.141592653589793 + asin(0.75))/2
//@ expect w at 1.5 = 4*(cos(2*away) - cos(3)) - 4*(1.5 - away) abs 1e-6
//@ expect locked at 0.1, 1, 1.92 = 1, 0, 1
//@ expect w at 2.2 = 4*(cos(2*back) - cos(4.4)) + 4*(2.2 - back) abs 1e-6
