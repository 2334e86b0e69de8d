//@ case relay
//@ status 3
model Relay
  Real x(start = 0.5, fixed = true);
  Real u;
equation
  //@ error[MO0911] 3-50
  u = if x > 0 then -1 else if x < 0 then 1 else 2;
  der(x) = u;
end Relay;
