// Parameters that are 0 in the text: a shorted resistor, iron losses that are switched off, and no mass.
// What they make vanish determines nothing, and the index is that of the circuit without it.
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
