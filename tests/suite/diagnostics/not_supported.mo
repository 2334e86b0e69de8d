// status: 1
// error[MO0200] 8:9
model Choice
  Integer k = if time > 0.5 then 2 else 1;
  Real x[3] = {1, 2, 3};
  Real y[2];
equation
  y = x[{k, k + 1}];
end Choice;
