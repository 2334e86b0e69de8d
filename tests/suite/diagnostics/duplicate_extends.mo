// status: 1
// error[MO0204] 8:8
model Base
  Real x = 1;
end Base;
model Box
  extends Base;
  Real x = 2;
end Box;
