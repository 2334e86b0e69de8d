// status: 1
// error[MO0203] 4:10
model Start
  Real x(begin = 1);
equation
  der(x) = -x;
end Start;
