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
