//@ case parameters_of_zero
//@ run stop=1 tolerance=1e-9
//@ snapshot structure
// Parameters that are 0 by declaration: a shorted resistor, iron losses that are switched off, and no mass.
// Terms that vanish determine nothing, and the index is that of the circuit without them.
model Vanishing
  parameter Real R = 0;
  parameter Real loss = 0;
  parameter Real mass = 0;
  Real v(start = 1, fixed = true);
  Real u;
  Real i;
  Real core;
  Real force;
  Real speed;
equation
  R*i = v - u;
  der(u) = -u - i - core;
  der(v) = i - v;
  if loss <= 0 then
    core = 0;
  else
    core = loss*u;
  end if;
  force = 2 - speed;
  if mass > 0 then
    mass*der(speed) = force;
  else
    force = 0;
  end if;
end Vanishing;
// v and u are one node, and so one state.
//@ expect structure has 1 "states (1): v"
//@ expect structure lacks "core"
//@ expect u = exp(-1) abs 1e-7
//@ expect core, speed = 0, 2
// With its resistance the node is two: u' = -u - (v - u) = -v, v' = (v - u) - v = -u.
//@ run set="R=1" stop=1 tolerance=1e-9
//@ expect v = cosh(1) abs 1e-7
