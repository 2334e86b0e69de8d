//@ case counter_beyond_exact_integers
//@ run stop=1
//@ status 3
// From 2^53 on the sum of an Integer and 1 may be the Integer itself.
model Counter
  //@ error[MO0935] 11
  Integer n(start = 9007199254740990, fixed = true);
equation
  when sample(0.1, 0.1) then
    n = pre(n) + 1;
  end when;
end Counter;

//@ case powers_of_ten
//@ run stop=1
//@ status 3
model Powers
  //@ error[MO0935] 11
  Integer n(start = 1, fixed = true);
equation
  when sample(0.01, 0.01) then
    n = 10*pre(n);
  end when;
end Powers;

//@ case large_but_exact
//@ run stop=0.25
model Counter
  Integer n(start = 9007199254740980, fixed = true);
equation
  when sample(0.1, 0.1) then
    n = pre(n) + 1;
  end when;
end Counter;
//@ expect n = 9007199254740982

//@ case remainder_of_a_literal_zero
//@ status 3
model Remainder
  Real u = time + 1;
  //@ error[MO0902] 8
  Real y = mod(u, 0);
end Remainder;

//@ case remainder_of_a_parameter_zero
//@ status 3
model Remainder
  parameter Real p = 0;
  Real u = time + 1;
  //@ error[MO0902] 8
  Real y = rem(u, p);
end Remainder;
