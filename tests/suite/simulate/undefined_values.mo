//@ case division_by_zero
//@ status 3
model Lever
  Real arm;
  Real force;
equation
  arm = 1 - time;
  //@ error[MO0902] 3-
  force =
    10/arm;
end Lever;

//@ case division_by_parameter
//@ run set=m=0
//@ status 3
model Body
  parameter Real m = 1;
  Real v(start = 1, fixed = true);
equation
  //@ error[MO0902] 3-15
  der(v) = -v/m;
end Body;

//@ case division_by_zero_at_a_corner
//@ run stop=1.5 interval=0.5 method=radau
//@ status 3
model Gap
  parameter Real d_0 = 0;
  Real s(start = 1, fixed = true);
  Real f;
equation
  der(s) = -1;
  //@ error[MO0902] 3-29
  f = 1 + 3/(d_0 + max(s, 0));
end Gap;

//@ case square_root_of_negative
//@ status 3
model Orifice
  Real dp;
  Real q;
equation
  dp = 0.5 - time;
  //@ error[MO0902] 3-16
  q = 2*sqrt(dp);
end Orifice;

//@ case logarithm_in_function
//@ run method=radau stop=1.1
//@ status 3
model Entropy
  function s
    input Real x;
    output Real y;
  algorithm
    y := x*log(x);
  end s;
  Real x(start = 1, fixed = true);
  //@ error[MO0902] 8
  Real y = s(x);
equation
  der(x) = -1;
end Entropy;

//@ case message_about_a_shared_expression
//@ run stop=1
//@ status 3
// Written out, the equation has more than 2^40 terms: the message shows where it is, and ends.
model Shared
  function mixed
    input Real x;
    output Real y;
  algorithm
    y := x;
    for k in 1:40 loop
      y := (sin(y) + y/(2 + cos(y)))/1.5;
    end for;
  end mixed;
  //@ error[MO0902] 8
  Real y = mixed(sqrt(0.5 - time));
end Shared;
