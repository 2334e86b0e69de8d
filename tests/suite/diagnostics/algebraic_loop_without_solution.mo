// status: 3
// error[MO0903] 7:3
// FIXME: should say that no solution is found; the matrix is singular only where the iteration got stuck.
model Loop
  Real x(start = 1);
equation
  x^2 = -1 - time;
end Loop;
