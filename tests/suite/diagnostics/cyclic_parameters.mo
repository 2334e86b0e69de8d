// status: 1
// error[MO0301] 4:18
model Box
  parameter Real length = 2*width;
  parameter Real width = area/length;
  parameter Real area = 6;
  Real x = length;
end Box;
