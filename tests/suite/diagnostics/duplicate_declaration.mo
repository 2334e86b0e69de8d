// status: 1
// error[MO0204] 6:11
model Box
  Real length = 1;
  Real width = 2;
  Integer length = 3;
end Box;
