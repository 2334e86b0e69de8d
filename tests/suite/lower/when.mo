//@ case two_whens_one_variable
model Count
  Integer n(start = 0, fixed = true);
equation
  when time > 0.5 then
    n = 1;
  end when;
  //@ error[MO0306] 3-
  when time > 0.7 then
    n = 2;
  end when;
end Count;

//@ case pre_of_a_continuous_variable
model Thermostat
  Real T(start = 290, fixed = true);
  //@ error[MO0325] 11-12
  Boolean on = pre(T) < 300;
equation
  der(T) = if on then 20 else -1;
end Thermostat;

//@ case pre_of_a_continuous_variable_at_an_event
// In a when-clause it is the value before the event.
model Ball
  Real h(start = 1, fixed = true);
  Real v(start = 0, fixed = true);
  discrete Real impact(start = 0, fixed = true);
equation
  der(h) = v;
  der(v) = -1;
  when h <= 0 then
    impact = pre(v);
    reinit(v, -0.8*pre(v));
  end when;
end Ball;
//@ run stop=1.5
//@ expect impact = -sqrt(2) rel 1e-5

//@ case reinit_at_the_start
//@ run stop=1 tolerance=1e-9
// Where `initial()` is a condition, `reinit` is an initial equation (section 8.6).
model Started
  Real x(start = 1), y(start = 1), z;
equation
  der(x) = 1;
  der(y) = 1;
  der(z) = 1;
  when initial() then
    reinit(x, 3);
    reinit(y, 2*x);
  end when;
  when {initial(), time > 0.5} then
    reinit(z, 7);
  end when;
end Started;
//@ expect x, y, z at start = 3, 6, 7
//@ expect x, y, z = 4, 7, 7.5 abs 1e-8
