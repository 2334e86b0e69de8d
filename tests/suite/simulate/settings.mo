//@ case wrong_interval
//@ run interval=0
//@ status 2
//@ error[MO0901] nowhere
model Flat
  Real x(start = 1, fixed = true);
equation
  der(x) = 0;
end Flat;
