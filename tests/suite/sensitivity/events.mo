//@ case bouncing_ball
//@ used by sensitivity.rs
model Ball
  parameter Real g = 9.81;
  parameter Real e = 0.8;
  parameter Real h0 = 1;
  Real h(start = h0, fixed = true);
  Real v(start = 0, fixed = true);
  Integer bounces(start = 0, fixed = true);
equation
  der(h) = v;
  der(v) = -g;
  when h <= 0 then
    reinit(v, -e * pre(v));
    bounces = pre(bounces) + 1;
  end when;
end Ball;

//@ case friction_stops_a_mass
//@ used by sensitivity.rs
model Slide
  parameter Real m = 2;
  parameter Real F = 3;
  parameter Real v0 = 1.5;
  Real s(start = 0, fixed = true);
  Real v(start = v0, fixed = true);
  Boolean stuck(start = false, fixed = true);
equation
  der(s) = v;
  m * der(v) = if stuck then 0 else -F;
  when v <= 0 then
    stuck = true;
    reinit(v, 0);
  end when;
end Slide;

//@ case switching_times_and_clocks
//@ used by sensitivity.rs
model Timed
  parameter Real T = 0.7;
  parameter Real first = 0.25;
  parameter Real period = 0.5;
  parameter Real a = 2;
  Real x(start = 0, fixed = true);
  Real y(start = 0, fixed = true);
  discrete Real u(start = 0, fixed = true);
equation
  der(x) = if time < T then 1 else -1;
  der(y) = u;
  when sample(first, period) then
    u = pre(u) + a;
  end when;
end Timed;
