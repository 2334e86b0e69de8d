//@ case relay_on_a_line
//@ used by sensitivity.rs
model Relay
  parameter Real c = 0.2;
  parameter Real r = 0.5;
  parameter Real k = 1;
  parameter Real b = 0.3;
  parameter Real d = 0.1;
  parameter Real y0 = 0.8;
  Real y(start = y0, fixed = true);
  Real z(start = 0, fixed = true);
  Real u = if y - b * time > d then 1 else -1;
equation
  der(y) = c + r * time - k * u;
  der(z) = u;
end Relay;

//@ case relay_on_a_circle
//@ used by sensitivity.rs
model Circle
  parameter Real c = 0.4;
  parameter Real k = 1;
  parameter Real w = 2;
  parameter Real m = 0.5;
  parameter Real R = 1.5;
  parameter Real r0 = 2;
  Real x(start = r0, fixed = true);
  Real y(start = 0, fixed = true);
  Real u = if x ^ 2 + y ^ 2 > R ^ 2 then 1 else -1;
equation
  der(x) = x * (c - k * u) - y * (w + m * u);
  der(y) = y * (c - k * u) + x * (w + m * u);
end Circle;

//@ case event_while_sliding
//@ used by sensitivity.rs
model Twice
  parameter Real c = 0.2;
  parameter Real e = -0.4;
  parameter Real k = 1;
  parameter Real d = 0.1;
  parameter Real v = 0.7;
  parameter Real h = 0.9;
  Real x(start = 0, fixed = true);
  Real y(start = 0.5, fixed = true);
  Real z(start = 0, fixed = true);
  Real u = if y > d then 1 else -1;
equation
  der(x) = v;
  der(y) = (if x > h then e else c) - k * u;
  der(z) = u;
end Twice;
