// status: 1
// error[MO0303] 4:18
model Box
  parameter Real length;
  Real x;
equation
  der(x) = -length*x;
end Box;
