//@ case function_arguments
model Call
  function twice
    input Real x;
    output Real y = 2*x;
  end twice;
  //@ error[MO1262] 12-18
  Real a = twice();
  //@ error[MO0219] 12-22
  Real b = twice(1, 2);
  //@ error[MO1261] 18
  Real c = twice(z = 2);
end Call;

//@ case function_sections
package P
  function begun
    input Real x;
    output Real y;
  //@ error[MO1285] 3-
  initial algorithm
    y := x;
  end begun;
  function twice
    input Real x;
    output Real y;
  algorithm
    y := x;
  //@ error[MO1285] 3-
  algorithm
    y := 2*y;
  end twice;
  partial function open
    input Real x;
    output Real y;
  algorithm
    y := x;
  end open;
  function short = open;
  model Top
    Real a = begun(1);
    Real b = twice(1);
    //@ error[MO1200] 14-20
    Real c = open(1);
    //@ error[MO1200] 14-21
    Real d = short(1);
  end Top;
end P;

//@ case derived_functions
model DerivedFunctions
  function f
    input Real x;
    input Real u[2];
    output Real y = x + u[1];
  algorithm
  end f;
  //@ error[MO1253] 29
  function by_what = der(f, z);
  function by_array = der(f, u);
  //@ error[MO1255] 26-29
  function of_what = der(Real, x);
  Real a = by_what(time, {1, 2});
  //@ error[MO0200] 12-33
  Real b = by_array(time, {1, 2});
  //@ error[MO0219] 12-24
  Real c = of_what(time);
end DerivedFunctions;

//@ case recursion_without_end
// A depth known only at run time, with vectors that get shorter: such a function has no fixed sizes.
model Sums
  function sum
    input Real x;
    input Real v[:];
    output Real s;
  algorithm
    // It never looks whether there are elements left.
    //@ error[MO1205] 31-50
    s := if x < 0 then 0 else sum(x - 1, v[2:end]) + sum(x - 2, cat(1, v, {x}));
  end sum;
  Real s = sum(time, {1, 2, 3});
end Sums;

//@ case loops_arrays_and_several_outputs
model Call
  function statistics
    input Real x[:];
    output Real mean = 0;
    output Real largest = x[1];
  protected
    Integer n = size(x, 1);
  algorithm
    for k in 1:n loop
      mean := mean + x[k]/n;
      if x[k] > largest then
        largest := x[k];
      end if;
    end for;
  end statistics;
  function newton_root
    input Real a;
    output Real r = 1;
  algorithm
    for k in 1:8 loop
      r := (r + a/r)/2;
    end for;
  end newton_root;
  Real m;
  Real l;
  Real r = newton_root(2 + time);
equation
  (m, l) = statistics({time, 2*time, 6});
end Call;
//@ expect m = 3 rel 1e-14
//@ expect l = 6
//@ expect r = sqrt(3) rel 1e-13

//@ case relations_in_arguments_and_in_functions
// Relations in arguments make events, those in functions do not.
model Arguments
  record Three
    Integer k;
    Boolean positive = k > 0;
  end Three;
  function doubled
    input Integer i;
    output Integer o;
  algorithm
    o := if i > 0 then 2*i else i;
  end doubled;
  function three
    input Integer i;
    output Three t;
  algorithm
    t := Three(doubled(i));
  end three;
  function above
    input Real u;
    input Real limit;
    output Real y;
  algorithm
    y := if u > limit then sqrt(u - limit) else 0;
  end above;
  function of_both
    input Real u;
    input Boolean b;
    output Real y;
  algorithm
    y := (if b and u > 0.3 then 2 else 1) + above(2*u, u) + floor(u);
  end of_both;
  Three made = Three(if time > 0.5 then 1 else -1);
  Three returned = three(if time > 0.5 then 1 else -1);
  Integer once = doubled(if time > 0.5 then 1 else -1);
  Integer twice = doubled(doubled(if time > 0.5 then 1 else -1));
  Real jump = above(if time > 0.5 then 2 + time else -time, 0.25);
  Real both = of_both(time, time > 0.5);
  Real chosen = above(time, 0.25);
  Integer k(start = 0, fixed = true);
equation
  when time > 0.75 then
    assert(made.k == 1 and made.positive, "a record");
    assert(returned.k == 2 and returned.positive, "a function with a record");
    assert(once == 2 and twice == 4, "whole numbers");
    assert(jump > 1 and both > 2, "numbers");
    k = pre(k) + once;
  end when;
end Arguments;
//@ expect made.k, returned.k, once, twice at start = -1
//@ expect made.k, returned.k, once, twice = 1, 2, 2, 4
//@ expect jump = sqrt(2.75) rel 1e-12
//@ expect both = 4 rel 1e-12
//@ expect chosen = sqrt(0.75) rel 1e-12
// One for each instant that equations name.
//@ expect events = 2

//@ case declarations_in_any_order
// Variables of a function get their values in the order of their dependencies.
model Ordered
  function padded
    input Real b[:];
    input Integer wanted = twice;
    output Real x[size(b, 1) + more] = cat(1, b, zeros(more));
  protected
    Integer more = wanted - count;
    Integer twice = 2 * count;
    Integer count = size(b, 1);
  algorithm
    x[1] := x[1] + more;
  end padded;
  Real x[3] = padded({1, 2}, 3);
  Real y[4] = padded({time, 2});
end Ordered;
//@ expect x[1:3] = 2, 2, 0
//@ expect y[1], y[2], y[4] = 3, 2, 0

//@ case functions_of_components
// Modifications of a short function definition see the component that the function is found in.
package Field
  function std
    input Real r;
    input Integer kind = 0;
    input Real g = 1;
    output Real a;
  algorithm
    a := if kind == 1 then g*r else -g;
  end std;
  model World
    parameter Integer kind = 1;
    parameter Real g = 9.81;
    replaceable function acc = std(kind=kind, g=2*g);
  end World;
  model Body
    outer World world;
    Real a = world.acc(time);
  end Body;
  model T
    inner World world(g=5);
    Body b;
    Real c = world.acc(1);
  end T;
  model T1
    World world(g=5);
    Real c = world.acc(1);
  end T1;
end Field;
//@ run model=Field.T
//@ expect c, b.a = 10
//@ run model=Field.T1
//@ expect c = 10

//@ case function_arguments_partially_applied
// Simpson's rule is exact for cubics: 2/3*x^3 + 1 from 0 to 3 has the integral 16.5.
package P
  partial function Integrand
    input Real u;
    output Real y;
  end Integrand;
  function simpson
    input Integrand f;
    input Real a;
    input Real b;
    output Real integral;
  algorithm
    integral := (b - a)/6*(f(a) + 4*f((a + b)/2) + f(u = b));
  end simpson;
  function cubic
    extends Integrand;
    input Real factor;
    input Real offset = 0;
  algorithm
    y := factor*u^3 + offset;
  end cubic;
  function twice
    input Integrand f;
    input Real x;
    output Real y = simpson(f, 0, x);
  algorithm
    y := 2*y;
  end twice;
  model Top
    Real whole = simpson(function cubic(factor = 2/3, offset = 1), 0, 3);
    Real passed = twice(function cubic(factor = 2/3, offset = 1), 3*time);
  end Top;
end P;
//@ expect whole = 16.5 rel 1e-12
//@ expect passed = 33 rel 1e-12

//@ case calls_in_branches_that_are_not_taken
//@ run stop=0.95
// A function is not called where its branch is not taken: it has no value there.
model Sampled
  function root
    input Real x;
    output Real y = 1;
  algorithm
    assert(x >= 0, "no root");
    while abs(y*y - x) > 1e-14 loop
      y := (y + x/y)/2;
    end while;
  end root;
  Real x = 0.55 - time;
  discrete Real y(start = 0, fixed = true);
  discrete Integer calls(start = 0, fixed = true);
equation
  when sample(0.1, 0.1) then
    y = if x > 0 then root(x) else -1;
    calls = pre(calls) + 1;
  end when;
end Sampled;
//@ expect y at 0.15, 0.35, 0.95 = sqrt(0.45), 0.5, -1 rel 1e-12
//@ expect calls at 0.15, 0.35, 0.95 = 1, 3, 9

//@ case assertions_after_a_return
//@ run stop=1 interval=0.125
// Nothing after a `return` that is taken counts, nor is it asserted.
model Left
  function small
    input Real x;
    output Real y;
  algorithm
    assert(x <= 0.5, "too large");
    y := 2*x;
  end small;
  function held
    input Real x;
    output Real y;
  algorithm
    if x > 0.5 then
      y := 1;
      return;
    end if;
    y := small(x);
  end held;
  Real y = held(time);
end Left;
//@ expect y at 0.25, 0.5, 1 = 0.5, 1, 1

//@ case a_field_that_is_left_out
model Pair
  record Gains
    Real low;
    Real high;
    Real middle = (low + high)/2;
  end Gains;
  parameter Gains given = Gains(1, 3);
  //@ error[MO1256] 30-43
  parameter Gains left_out = Gains(low = 1);
  Real y = given.middle + left_out.high;
end Pair;

//@ case an_integer_of_a_large_function_that_is_a_literal
// The phase does not change between events, although the function is called; `d` is a sum of 700 terms, in
// double precision with Python.
model Phases
  record State
    Real d;
    Integer phase;
    Real p;
  end State;
  function state
    input Real p;
    output State s;
  protected
    Real d = 0;
  algorithm
    for k in 1:700 loop
      d := d + sin(k*p)/k^2;
    end for;
    s := State(d, 0, p);
  end state;
  State s;
equation
  s = state(time);
end Phases;
//@ run stop=1
//@ expect s.d = 1.0139612512785126 rel 1e-12
//@ expect s.phase = 0
//@ expect s.p = 1

//@ case fields_by_later_constants
//@ run stop=1
// The value of a field of the output reads a constant that is declared after it.
package Curves
  record Curve
    parameter Real x[:];
    parameter Real y[size(x, 1)];
  end Curve;
  function constant2
    input Real level;
    output Curve c(x = {0, 1, 2}, y = zeros(n));
  protected
    constant Integer n = 3;
  algorithm
    for k in 1:n loop
      c.y[k] := level*k;
    end for;
  end constant2;
  model User
    parameter Curve c = constant2(5);
    Real y[3] = c.y*time;
  end User;
end Curves;
//@ expect y[1], y[2], y[3] = 5, 10, 15

//@ case records_are_assigned_by_name
model ByName
  record R
    Real a;
    Real b;
  end R;
  record S
    Real b;
    Real a;
  end S;
  function turned
    input S s;
    output R r;
    output Real y = 3;
  algorithm
    r := s;
  end turned;
  S s(a = 1, b = 2);
  S several[2] = {S(b = 20, a = 10), S(b = 40, a = 30)};
  R r, q, t, all[2], u;
  discrete R w;
  Real y;
algorithm
  r := s;
  all := several;
  (u, y) := turned(s);
equation
  q = s;
  t = turned(s);
  when time > 0.5 then
    w = s;
  end when;
  annotation(experiment(StopTime = 1));
end ByName;
//@ expect r.a, r.b, q.a, q.b, t.a, t.b, u.a, u.b = 1, 2, 1, 2, 1, 2, 1, 2
//@ expect all[1].a, all[1].b, all[2].a, all[2].b = 10, 20, 30, 40
//@ expect w.a, w.b = 1, 2

//@ case record_without_a_field_is_assigned
model Lacks
  record R
    Real a;
    Real b;
  end R;
  record S
    Real a;
    Real c;
  end S;
  S s(a = 1, c = 2);
  R r;
algorithm
  //@ error[MO1221] 3-8
  r := s;
end Lacks;

//@ case a_call_after_a_return
// What leads to a call is no part of the function, which other calls share.
model Calls
  function last
    input Real u[:];
    input Integer m;
    output Real w[size(u, 1)];
  protected
    Real q[size(u, 1), 2];
  algorithm
    q := [u, 2*u];
    w := u;
    w[end] := q[1 + mod(m, size(q, 1)), 2];
  end last;
  function guarded
    input Real x;
    input Real u[:];
    input Integer m;
    output Real y;
  protected
    Real v[3];
  algorithm
    y := 0;
    if x >= u[1 + mod(m, 2)] then
      return;
    end if;
    v := last({1, 2, x}, m);
    y := v[3];
  end guarded;
  Integer m = if time > 0.5 then 2 else 1;
  Real y = guarded(2*time, {1.5, 1.25}, m);
  Real z = sum(last({time, 2, 3}, m));
  annotation(experiment(StopTime = 1));
end Calls;
//@ expect y at 0.25, 0.6, 0.7, 0.9 = 4, 2.4, 2.8, 0 abs 1e-12
//@ expect z at 0.25, 0.75 = 0.25 + 2 + 4, 0.75 + 2 + 6
