//@ case types_in_algorithms
model Mixed
  type Kind = enumeration(a, b);
  Real x;
  Real y;
  Boolean b;
  Kind e;
  Integer i;
algorithm
  //@ error[MO0212] 3-10
  x := "a";
algorithm
  //@ error[MO0212] 3-11
  y := true;
algorithm
  //@ error[MO0212] 3-10
  b := 2.5;
algorithm
  //@ error[MO0212] 3-8
  e := 7;
algorithm
  //@ error[MO0212] 3-10
  i := 5/2;
end Mixed;

//@ case types_in_when_equations
model Mixed
  Real x(start = 1, fixed = true);
  Real z(start = 1, fixed = true);
  Boolean c(start = false, fixed = true);
  Integer h(start = 0, fixed = true);
  Integer j(start = 1, fixed = true);
equation
  der(x) = 1;
  when time > 0.5 then
    //@ error[MO0212] 5-9
    c = 3;
  end when;
  when time > 0.6 then
    //@ error[MO0212] 5-12
    h = time;
  end when;
  when time > 0.7 then
    //@ error[MO0212] 5-20
    j = pre(j) + 0.5;
  end when;
  when time > 0.8 then
    //@ error[MO0212] 5-11
    z = "a";
  end when;
  when time > 0.9 then
    //@ error[MO0212] 15-19
    reinit(x, false);
  end when;
end Mixed;

//@ case integers_of_equations
model Fractions
  Integer i;
  parameter Integer n(fixed = false);
initial equation
  //@ error[MO0212] 3-9
  n = 2.5;
equation
  //@ error[MO0212] 3-9
  i = 5/2;
end Fractions;

//@ case types_in_functions
model Mixed
  function f
    input Real x;
    output Real y;
  protected
    Integer k;
  algorithm
    //@ error[MO0212] 5-12
    k := x/2;
    y := k;
  end f;
  function g
    input Integer n;
    output Real y = n;
  end g;
  function h
    input Real x;
    output Boolean y;
  protected
    //@ error[MO0212] 17-19
    Integer k = x/2;
  algorithm
    y := k > 2;
  end h;
  Real a = f(2.5 + time);
  //@ error[MO0212] 12-17
  Real b = g(2.5);
  Boolean c = h(3.5);
end Mixed;

//@ case allowed_types
//@ run stop=1
// Integers become Real, and operators on Integers give Integers.
model Allowed
  type Kind = enumeration(a, b);
  function f
    input Real x[:];
    input Integer n;
    input Kind kind;
    output Real y;
    output Integer k;
    output String s;
  protected
    Real w[2];
    Real open[:];
  algorithm
    w := {1, 2};
    w[1] := n;
    open := x;
    open := w;
    k := abs(n) + max(n, 2) - min({n, 3}) + sum({n, n}) + product({1, 2}) + mod(n, 2) + div(n, 2)
      + rem(n, 3) + integer(2.7) + size(x, 1) + Integer(kind) + sign(n)*n + (if n > 2 then 1 else 2)
      + {1, 2}*{n, n} + noEvent(n) + sum(i for i in 1:n);
    y := k;
    y := y + sum(open);
    s := String(k);
  end f;
  Real x(start = 0, fixed = true);
  Real y;
  Integer k;
  Real v[3];
  Integer m[2, 2];
  discrete Real d(start = 0, fixed = true);
  Kind e(start = Kind.a, fixed = true);
equation
  der(x) = 1;
  (y, k) = f({1, 2}, 4, Kind.b);
  when time > 0.5 then
    reinit(x, 2);
    d = 3;
    e = Kind.b;
  end when;
algorithm
  v := {1, 2, 3};
  v[2:3] := {5, 6};
  m := identity(2);
  m[1, :] := {k, 2};
  m[2, 1] := k - 1;
end Allowed;
//@ expect v[1], v[2], v[3], d, e = 1, 5, 6, 3, 2
//@ expect x = 2.5 rel 1e-6

//@ case shapes_of_assignments
model Shapes
  record R
    Real a[2];
    Real b;
  end R;
  R r;
  Real a[2, 3];
  Real v[4];
  Real w[2, 3];
algorithm
  //@ error[MO0215] 3-25
  a := [1, 2; 3, 4; 5, 6];
algorithm
  //@ error[MO0212] 3-19
  v := [1, 2; 3, 4];
algorithm
  //@ error[MO0212] 3-16
  r := {1, 2, 3};
equation
  when time > 0.5 then
    //@ error[MO0215] 5-26
    w = [1, 2; 3, 4; 5, 6];
  end when;
end Shapes;

//@ case shapes_of_arguments
model Shapes
  function fixed3
    input Real x[3];
    output Real y = sum(x);
  end fixed3;
  function counted
    input Integer n;
    input Real x[n];
    output Real y = sum(x);
  end counted;
  function both
    input Real x[:];
    input Real z[size(x, 1)];
    output Real y = x*z;
  end both;
  function poured
    input Real x[:];
    output Real y;
  protected
    Real z[2];
  algorithm
    //@ error[MO1239] 5-10
    z := x;
    y := sum(z);
  end poured;
  function square
    input Real x[:, size(x, 1)];
    output Real y = sum(x);
  end square;
  record R
    Real v[2];
  end R;
  record S
    Real v[3];
  end S;
  function field
    input R r;
    output Real y = sum(r.v);
  end field;
  S s(v = {1, 2, 3});
  //@ error[MO1239] 12-31
  Real a = fixed3({1, 2, 3, 4});
  //@ error[MO1239] 12-32
  Real b = counted(2, {1, 2, 3});
  //@ error[MO1239] 12-34
  Real c = both({1, 2}, {1, 2, 3});
  Real d = poured({1, 2, 3});
  //@ error[MO1239] 12-37
  Real e = square([1, 2, 3; 4, 5, 6]);
  //@ error[MO1239] 12-19
  Real g = field(s);
end Shapes;

//@ case records_by_name
//@ run stop=1
model ByName
  record R
    Real a;
    Real b;
  end R;
  record S
    Real b;
    Real a;
  end S;
  S s(a = 1, b = 2);
  R r;
  R q;
algorithm
  r := s;
equation
  q = s;
end ByName;
//@ expect r.a, r.b, q.a, q.b = 1, 2, 1, 2

//@ case loop_variable
model Count
  function f
    input Real u;
    output Real s = 0;
  algorithm
    for i in 1:3 loop
      s := s + i*u;
      //@ error[MO0251] 7
      i := i + 1;
    end for;
  end f;
  Real y = f(time);
end Count;

//@ case unassigned_output
model Undefined
  function f
    input Real x;
    //@ error[MO0252] 17
    output Real y;
    output Real z;
  algorithm
    z := x;
  end f;
  Real y;
  Real z;
equation
  (y, z) = f(time);
end Undefined;

//@ case assigned_outputs
//@ run stop=1
// Outputs that are assigned by field or element, or that have no elements, are fine.
model Defined
  record R
    Real a;
    Real b = 2;
  end R;
  function f
    input Real x;
    output R r;
    output Real v[2];
    output R s(a = 1);
    output Real none[0];
  algorithm
    r.a := x;
    for i in 1:2 loop
      v[i] := i*x;
    end for;
  end f;
  record P
    Real a;
    Real b;
  end P;
  P r;
  Real v[2];
  P s;
equation
  (r, v, s) = f(time);
end Defined;
//@ expect r.a, v[2], s.a = 1, 2, 1
