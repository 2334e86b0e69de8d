//@ case lag
//@ used by measured.rs
model Lag
  parameter Real k(unit = "1/s") = 1 "Rate";
  input Real u(unit = "V");
  Real x(start = 0, fixed = true, unit = "V");
equation
  der(x) = k*(u - x);
  annotation(experiment(Tolerance = 1e-9));
end Lag;

//@ case ohm
//@ used by measured.rs
model Ohm "A resistor, and a capacitor behind another"
  parameter Real R = 1.5;
  input Real i;
  Real u = R*i;
  Real x(start = 0, fixed = true);
equation
  der(x) = i - x;
end Ohm;

//@ case ohm_with_events
//@ used by measured.rs
model OhmWithEvents "The same, with a relation that changes and a clock that ticks at samples"
  parameter Real R = 1.5;
  input Real i;
  Real u = R*i;
  Real x(start = 0, fixed = true);
  discrete Real sampled(start = 0, fixed = true);
  Boolean high(start = false, fixed = true);
equation
  der(x) = i - x;
  when sample(0, 1) then
    sampled = R*i;
  end when;
  high = x > 0.3;
end OhmWithEvents;
