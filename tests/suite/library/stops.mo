//@ case free_body_swings_without_events
//@ run stop=3 tolerance=1e-9
model Swing
  Translational.StopMass body(m = 1, s_min = -1, s_max = 1, s_start = 0.5,
    mode_start = Translational.Motion.Locked);
  Translational.Spring spring(c = 100);
  Translational.Fixed wall;
equation
  connect(spring.flange_a, wall.flange);
  connect(spring.flange_b, body.flange);
end Swing;
//@ expect each body.s = 0.5*cos(10*time) abs 1e-7
// The first reversal, at half a period.
//@ expect events = 1 at pi/10 rel 1e-8

//@ case free_motion_ends_at_a_stop
//@ run stop=7 interval=0.01 tolerance=1e-9
// It meets a stop from free motion, rests there without rebound, and leaves it again.
model Thrown
  Translational.StopMass body(m = 1, s_min = -1, s_max = 1, s_start = 0, v_start = 1,
    mode_start = Translational.Motion.Forward);
  Translational.Force force(f = if time < 2 then -1 elseif time < 4 then 1 else -2);
equation
  connect(force.flange, body.flange);
end Thrown;
// Up to 0.5 m at 1 s and back; at the lower stop at 1 + sqrt(3) s, unless pushed from 2 s on: then it turns before.
// From 2 s (s = 0, v = -1) s = -t' + t'^2/2 turns at -0.5 m, and is back at 0 at 4 s with v = 1.
//@ expect body.s at 1, 3 = 0.5, -0.5 rel 1e-8
// From 4 s s = t' - t'^2: it turns at 0.25 m and arrives at -1 m after (1 + sqrt(5))/2 s.
//@ expect events "s_left" at 4 + (1 + sqrt(5))/2 rel 1e-8
//@ expect body.s, body.v = -1, 0

//@ case slow_sine_between_two_stops
//@ run stop=60
// A force of 20 N at 0.05 Hz against 7 N of static friction: in each half period the body breaks away
// at `20 sin(2 pi f t) = 7`, runs to the other stop and stays there, without a rebound or a second try.
model Slow
  Translational.StopMass body(m = 1, s_min = -0.5, s_max = 0.5, s_start = -0.5);
  Translational.Force push;
  model Rubber = Friction.Stribeck(F_Coulomb = 5, F_Stribeck = 2, F_prop = 1, f_exp = 2);
  Seals.SingleSeal seal(contact = Seals.Contact.CloseOnly, redeclare model FrictionLaw = Rubber);
  Pneumatics.Ambient ambient;
equation
  push.f = 20*sin(2*3.14159265358979323846*0.05*time);
  connect(push.flange, body.flange);
  connect(seal.spool, body.seals);
  connect(seal.port_a, ambient.port);
  connect(seal.port_b, ambient.port);
end Slow;
//@ let first = asin(7/20)/(2*pi*0.05)
//@ expect events "> body.f_static became true" = 6 at first + 10*(k - 1) rel 1e-6
//@ expect body.s, body.v at first + 5 = 0.5, 0
//@ expect body.s, body.v at first + 15 = -0.5, 0
//@ expect body.s, body.v at first + 25 = 0.5, 0
//@ expect body.s, body.v at first + 35 = -0.5, 0
//@ expect body.s, body.v at first + 45 = 0.5, 0
//@ expect body.s, body.v at first + 55 = -0.5, 0
//@ expect each abs(body.s) <= 0.5 + 1e-12
