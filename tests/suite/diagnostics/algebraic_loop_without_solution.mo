// status: 3
// error[MO0904] 6:3
model Loop
  Real x(start = 1);
equation
  x^2 = -1 - time;
end Loop;
