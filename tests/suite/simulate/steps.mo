//@ case finite_escape
//@ run method=radau
//@ status 3
model Escape
  //@ error[MO0909] 8
  Real x(start = 1, fixed = true);
equation
  der(x) = x^2;
  annotation(experiment(StopTime = 2));
end Escape;
