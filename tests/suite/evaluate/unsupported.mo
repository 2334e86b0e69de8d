//@ case unknown_in_connector
// An unknown type is reported once: its uses cause no further errors.
model Sampled
  "A clock that comes in from outside"
  connector ClockInput = input Clock;
  //@ error[MO0201] 16-19
  type Level = Reel;
  ClockInput c;
  Level h;
  Real u = time, y, z;
equation
  when c then
    y = h;
  end when;
  z = h + sample(u, c) + y;
end Sampled;

//@ case derivative_of_derivative
model Fall
  Real h(start = 1, fixed = true);
equation
  //@ error[MO0200] 3-13
  der(der(h)) = -9.81;
end Fall;

//@ case delay_of_the_variable_of_a_loop
model Loop
  discrete Integer n(start = 1, fixed = true);
  Integer w[4];
equation
  when sample(0.5, 0.5) then
    n = pre(n) + 1;
  end when;
algorithm
  w := {0, 0, 0, 0};
  for i in 2:2:n loop
    //@ error[MO0200] 7-19
    w[delay(i, 0.1)] := i;
  end for;
end Loop;
