//@ case missing_semicolon
model Tank
  //@ error[MO0003] 24
  Real level(start = 1)
equation
  der(level) = -level;
end Tank;

//@ case several_errors
model Tank
  //@ error[MO0004] 23
  Real level(start = 1;
equation
  //@ error[MO0007] 14-15
  der(level) := -level;
//@ error[MO0005] 5-8
end Tonk;
