//@ case cycle
model Box
  //@ error[MO0301] 18-23
  parameter Real length = 2*width;
  parameter Real width = area/length;
  parameter Real area = 6;
  Real x = length;
end Box;

//@ case no_value
model Box
  //@ error[MO0303] 18-23
  parameter Real length;
  Real x;
equation
  der(x) = -length*x;
end Box;

//@ case two_first_values
model Count
  discrete Integer n(start = 1, fixed = true);
equation
  when time > 0.5 then
    n = pre(n) + 1;
  end when;
initial equation
  //@ error[MO0335] 3-12
  pre(n) = 2;
end Count;

//@ case one_first_value_said_twice
model Count
  discrete Integer n(start = 2, fixed = true);
equation
  when time > 0.5 then
    n = pre(n) + 1;
  end when;
initial equation
  pre(n) = 2;
end Count;
//@ expect n = 3

//@ case attributes_of_another_type
model Box
  //@ error[MO0212] 17
  Real x(unit = 1) = 1;
  //@ error[MO0212] 18
  Real y(fixed = 1, start = 2);
equation
  der(y) = 1;
end Box;

//@ case starts_that_initialization_determines
//@ run stop=1 tolerance=1e-9
model Counters
  parameter Real p(fixed = false, start = 1);
  parameter Real r = 2*p;
  discrete Real d(start = p, fixed = true);
  discrete Real d2(start = r, fixed = true);
  discrete Real d3, d4;
  Real y(start = p, fixed = true);
equation
  when sample(0.5, 1) then
    d = pre(d) + 1;
    d2 = pre(d2) + 1;
    d3 = pre(d3) + 1;
    d4 = pre(d4) + 1;
  end when;
  der(y) = 1;
initial equation
  p = 3;
  pre(d3) = p;
  2*pre(d4) - y = 0;
end Counters;
//@ expect d, d2, d3, d4 at start = 3, 6, 3, 1.5
//@ expect d, d2, d3, d4 = 4, 7, 4, 2.5

//@ case two_first_values_that_vary
model Twice
  discrete Real d;
  Real x(start = 2, fixed = true);
equation
  der(x) = 1;
  when sample(0.5, 1) then
    d = pre(d) + 1;
  end when;
initial equation
  pre(d) = x;
  //@ error[MO0335] 3-18
  pre(d) - 2*x = 0;
end Twice;
