//@ case machine
//@ used by results.rs
model Machine "A bit of everything"
  type Mode = enumeration(Slow, Fast);
  parameter Real m(unit = "kg") = 2.5 "Mass";
  parameter Real k(fixed = false, start = 1) "Found at the start";
  constant Real two = 2;
  Real x(start = 1, fixed = true, unit = "m", displayUnit = "mm") "Place";
  Real same = x;
  Real other = -x;
  Real rest = 3*m + two;
  Boolean high(start = true, fixed = true) = x > 0.5;
  Integer n(start = 0, fixed = true);
  Mode mode = if high then Mode.Slow else Mode.Fast;
initial equation
  der(x) = -3;
equation
  der(x) = -k*x;
  when x < 0.25 then
    n = pre(n) + 1;
  end when;
  annotation(experiment(StopTime = 1, Interval = 0.1));
end Machine;
