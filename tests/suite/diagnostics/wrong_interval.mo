// status: 2
// error[MO0901] -
// args: --interval 0
model Flat
  Real x(start = 1, fixed = true);
equation
  der(x) = 0;
end Flat;
