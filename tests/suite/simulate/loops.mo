//@ case algebraic_loop_without_solution
//@ status 3
model Loop
  Real x(start = 1);
equation
  //@ error[MO0904] 3-17
  x^2 = -1 - time;
end Loop;

//@ case boolean_loop
//@ status 3
model Twice
  Real x(start = 1, fixed = true);
  Boolean b;
  Boolean c;
equation
  der(x) = if b then 1 else -1;
  //@ error[MO0905] 3-11
  b = not c;
  c = b;
end Twice;
