//@ case slices_of_records
//@ run stop=1 also=flat
// A subscript behind an array of records belongs to the field: `b.v[2]` is that of each of them.
package P
  record C Real v[2]; end C;
  record R Real m[2, 3]; end R;
  function second
    input C b[2];
    output Real s[2];
  algorithm
    s := b.v[2];
  end second;
  function column
    input R r[2];
    output Real s;
  algorithm
    s := sum(r.m[2, 3]) + sum(r[2:2].m[1, 1:2]);
  end column;
  function written
    input Real x;
    output C c[2];
  algorithm
    c.v := {{1, 2}, {3, 4}};
    c.v[2] := {7, x};
    c[2].v[1] := 5;
  end written;
  model M
    C b[2](v = {{1, 2*time}, {3, 4}});
    Real s[2] = second(b);
    Real m[2] = b.v[2];
    R r[2](m = {{{1, 2, 3}, {4, 5, 6}}, {{7, 8, 9}, {10, 11, 12}}});
    Real t = column(r);
    C c[2] = written(9*time);
  end M;
end P;
//@ expect s[1:2] = 2, 4
//@ expect m[1:2] = 2, 4
//@ expect t = 6 + 12 + 7 + 8
//@ expect c[1].v[1], c[1].v[2], c[2].v[1], c[2].v[2] = 1, 7, 5, 9

//@ case modified_in_functions
//@ run stop=1
// As in a model, other fields and sizes see the value that a modification gives, and deeper fields are reached.
package P
  record R Real a = 1; Real b = 2*a; end R;
  record V parameter Integer n = 2; Real d[n] = fill(1.0, n); end V;
  record S R r; R many[2](a = {5, 6}); end S;
  function f
    input Real x;
    output Real y[7];
  protected
    R r(a = 5);
    V v(n = 4);
    S s(r(a = x));
    R each_one[2](each a = x);
    R both[2](a = {x, 3*x});
  algorithm
    y := {r.b, size(v.d, 1), sum(v.d), s.r.b, s.many[2].b, each_one[2].b, both[2].b};
  end f;
  model M
    Real y[7] = f(time);
  end M;
end P;
//@ expect y[1:7] = 10, 4, 4, 2, 12, 2, 6

//@ case nested_defaults
//@ run stop=1
// A constructor takes the defaults of nested records with their modifications.
package P
  record R Real a = 1; Real b = 2*a; end R;
  record S R r(a = 4); end S;
  record T Real x = 3; R v[2](a = {5, 6}); end T;
  model M
    S s;
    S c = S();
    T t = T(x = time);
    R many[2] = R({1, 2*time});
  end M;
end P;
//@ expect s.r.b, c.r.b = 8, 8
//@ expect t.v[2].b = 12
//@ expect many[1].b, many[2].b = 2, 4

//@ case redeclared_field
package P
  record A Real x = 1; end A;
  record A2 extends A(x = 6); end A2;
  record B replaceable A a; end B;
  function f
    input Real x;
    output Real y;
  protected
    //@ error[MO0200] 9-22
    B b(redeclare A2 a);
  algorithm
    y := x*b.a.x;
  end f;
  model M
    Real y = f(time);
  end M;
end P;

//@ case operators_of_records
//@ run stop=1
model M
  record C Real a; Real b; end C;
  function s
    input C c;
    output Real y = c.a + c.b;
  end s;
  C c(a = time, b = 2*time);
  Real y = s(noEvent(c));
end M;
//@ expect y = 3

//@ case statements_with_records
// What has no meaning for records is an error, and not left out with the rest of its clause.
model M
  record C Real a(start = 1); Real b(start = 2); end C;
  C c;
  Real x(start = 0, fixed = true);
  Real v[3] = {1, 2, 3};
  parameter Real p = 1.6;
  //@ error[MO0212] 14
  Real w = v[p];
initial equation
  //@ error[MO0212] 3-8
  der(c) = C(-5, 0);
equation
  c.a = time;
  c.b = time;
  der(x) = 1;
  when time > 0.5 then
    //@ error[MO0212] 15-20
    reinit(x, der(c));
  end when;
end M;

//@ case literals_only
//@ run stop=1 also=flat
// The flat text declares a type of which only literals are left.
model M
  type E = enumeration(a, b, c);
  Integer i = Integer(if time > 0.5 then E.c else E.b);
end M;
//@ expect i at 0.4, 1 = 2, 3

//@ case recursive_record_output
//@ run stop=1
// The depth is known at run time only. The first value of a field reads an input.
package P
  record R Real a; Real b; end R;
  function down
    input Integer n;
    input Real x;
    output R r(b = 3*x);
  algorithm
    if n > 0 then
      r := down(n - 1, x);
      r.a := r.a + 1;
    else
      r.a := x;
    end if;
  end down;
  model M
    discrete Integer n(start = 3, fixed = true);
    R r;
  equation
    when time > 0.5 then
      n = 5;
    end when;
    r = down(n, 10*time);
  end M;
end P;
//@ expect r.a, r.b at 1 = 10 + 5, 30
