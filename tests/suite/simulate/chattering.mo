//@ case relay
//@ status 3
model Relay
  Real x(start = 0.5, fixed = true);
  Real u;
equation
  //@ error[MO0911] 3-50
  u = if x > 0 then -1 else if x < 0 then 1 else 2;
  der(x) = u;
end Relay;

//@ case hidden_switching
//@ status 3
// Without an event the integrator follows every switch of the relay with steps as short as its tolerance.
model Relay
  Real x(start = 0.5, fixed = true);
equation
  //@ error[MO0933] 3-43
  der(x) = noEvent(if x > 0 then -1 else 1);
end Relay;

//@ case sign_at_rest
//@ run stop=2 method=dopri
//@ status 3
// `sign` has no events: at rest it switches in every step.
model Block
  Real v(start = 0.1, fixed = true);
equation
  //@ error[MO0933] 3-30
  der(v) = -sign(v) + 0.2*time;
end Block;

//@ case sliding_without_a_warning
// On the surface, x decays as exp(-2 t) from where it is reached: no event is missed there, and nothing is warned of.
model Surface
  Real v(start = 1, fixed = true);
  Real x(start = 0, fixed = true);
  Real s = x + 0.5*v;
equation
  der(x) = v;
  der(v) = -3*(if s > 0 then 1 else -1) + 0.5*sin(3*time);
  annotation(experiment(StopTime = 10, Interval = 0.5));
end Surface;
//@ expect each x + 0.5*v = 0 where time > 2 abs 1e-5

//@ case sliding_that_comes_to_rest
//@ run stop=4
// From 3 on both branches agree.
model Fading
  Real x(start = 1, fixed = true);
  Real a = max(0, 3 - time);
equation
  der(x) = if x > 0 then -a else a;
end Fading;
//@ expect x = 0 abs 1e-6

//@ case sliding_that_nothing_determines
//@ run stop=4
//@ status 3
// From 3 on either branch stays at the border, and z may grow at any rate between theirs.
model Fading
  Real x(start = 1, fixed = true);
  Real a = max(0, 3 - time);
  Real z(start = 0, fixed = true);
equation
  //@ error[MO0902] 3-34
  der(x) = if x > 0 then -a else a;
  der(z) = if x > 0 then 1 else 2;
end Fading;
