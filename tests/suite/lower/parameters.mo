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
