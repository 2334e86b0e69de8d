//@ case large_function_called_often
//@ used by stages.rs
// Forty copies of the body would be large: the calls stay. Heron's method finds the square root.
model Roots
  function root
    input Real a;
    output Real x = 1 + a;
  algorithm
    for k in 1:1000 loop
      x := (x + a/x)/2;
    end for;
  end root;
  parameter Integer n = 40;
  Real y[n];
  Real z(start = 4, fixed = true);
  Real w(start = 3);
equation
  for k in 1:n loop
    y[k] = root(k + time);
  end for;
  der(z) = -root(z);
  root(w) = 2 + time;
  annotation(experiment(StopTime = 1, Tolerance = 1e-9));
end Roots;
// der(z) = -sqrt(z).
//@ expect each y[1] = sqrt(1 + time) rel 1e-14
//@ expect each y[40] = sqrt(40 + time) rel 1e-14
//@ expect each z = (2 - time/2)^2 rel 1e-7
//@ expect each w = (2 + time)^2 rel 1e-9

//@ case large_function_called_twice
//@ used by stages.rs
// Two copies are few: they are inlined when all calls are known.
model Roots
  function root
    input Real a;
    output Real x = 1 + a;
  algorithm
    for k in 1:1000 loop
      x := (x + a/x)/2;
    end for;
  end root;
  Real y = root(4 + time);
  Real z(start = 4, fixed = true);
equation
  der(z) = -root(z);
  annotation(experiment(StopTime = 1, Tolerance = 1e-9));
end Roots;
//@ expect y at 0, 1 = 2, sqrt(5) rel 1e-14
//@ expect z = 2.25 rel 1e-7

//@ case large_function_annotated
//@ used by stages.rs
// The annotation decides, however many calls there are.
model Roots
  function root
    input Real a;
    output Real x = 1 + a;
  algorithm
    for k in 1:1000 loop
      x := (x + a/x)/2;
    end for;
    annotation(LateInline = true);
  end root;
  Real y[40] = {root(k + time) for k in 1:40};
  annotation(experiment(StopTime = 1));
end Roots;
//@ expect y[3], y[8] at 1 = 2, 3 rel 1e-14

//@ case large_function_differentiated
// A constraint must be differentiated, so the function that it calls is inlined there.
model Constraint
  function root
    input Real a;
    output Real x = 1 + a;
  algorithm
    for k in 1:1000 loop
      x := (x + a/x)/2;
    end for;
  end root;
  Real y[40] = {root(k + time) for k in 1:40};
  Real x(start = 1);
  Real v;
equation
  der(x) = v;
  root(x) = 1 + time;
  annotation(experiment(StopTime = 1));
end Constraint;
// x = (1 + t)^2
//@ expect each x = (1 + time)^2 rel 1e-6
//@ expect each v = 2*(1 + time) rel 1e-6
//@ expect y[3] = 2 rel 1e-14

//@ case records_arrays_and_several_outputs
//@ run stop=1 also=flat
// One body serves arguments of equal sizes and types; a literal is a part of the body.
model Shapes
  record Point
    Real x;
    Real y;
    Boolean on;
  end Point;
  function moved
    input Point p;
    input Real by[:];
    input Real scale = 2;
    output Point q;
    output Real length;
  algorithm
    q := p;
    for k in 1:size(by, 1) loop
      q.x := q.x + by[k]*scale;
    end for;
    if p.on then
      q.y := -p.y;
    end if;
    length := sqrt(q.x^2 + q.y^2);
  end moved;
  Point a;
  Point b;
  Real la, lb, lc;
  Boolean on = time > 0.5;
equation
  (a, la) = moved(Point(time, 4, on), {1, time});
  (b, lb) = moved(Point(time, 1, on), {time, time, time}, 1);
  (, lc) = moved(Point(3*time, 4, on), {0, 0});
end Shapes;
//@ expect a.x, a.y, la at 0 = 2, 4, sqrt(20) rel 1e-12
//@ expect a.x, a.y, la = 5, -4, sqrt(41) rel 1e-12
//@ expect b.x, b.y, lb, lc = 4, -1, sqrt(17), 5 rel 1e-12
//@ expect events = 1

//@ case parameters_decide
//@ run stop=1 set=n=3
// An Integer parameter decides the size of an array and a trip count, a Boolean one a branch.
model Sizes
  function sum_of_powers
    input Real x;
    input Integer n;
    input Boolean twice;
    output Real y = 0;
  protected
    Real p[n];
  algorithm
    for k in 1:n loop
      p[k] := x^k;
      y := y + p[k];
    end for;
    if twice then
      y := 2*y;
    end if;
  end sum_of_powers;
  parameter Integer n = 2;
  parameter Boolean twice = true;
  Real y = sum_of_powers(1 + time, n, twice);
end Sizes;
//@ expect y at 0, 1 = 6, 28 rel 1e-12

//@ case relations_have_no_events
//@ run stop=1
// Relations of a function have no events, those of its arguments do.
model Relations
  function chosen
    input Real x;
    input Boolean on;
    output Real y;
  algorithm
    y := if x > 0.25 and on then 1 else 0;
  end chosen;
  Real y = chosen(time, time > 0.5);
end Relations;
//@ expect events "time > 0.5" = 1 at 0.5 abs 1e-9
//@ expect events = 1
//@ expect y at 0.4, 1 = 0, 1

//@ case assertion_of_a_large_function
//@ status 3
// The assertion is checked inside of the function, whose calls stay.
model Roots
  function root
    input Real a;
    output Real x = 1 + a;
  algorithm
    //@ error[MO0906] 5-49
    assert(a < 41.5, String(a) + " is too large");
    for k in 1:1000 loop
      x := (x + a/x)/2;
    end for;
  end root;
  Real y[40] = {root(k + 2*time) for k in 1:40};
  annotation(experiment(StopTime = 1));
end Roots;

//@ case assertion_of_a_large_function_called_once
//@ status 3
// The assertion becomes one of the equation.
model Roots
  function root
    input Real a;
    output Real x = 1 + a;
  algorithm
    //@ error[MO0912] 5-49
    assert(a < 41.5, String(a) + " is too large");
    for k in 1:1000 loop
      x := (x + a/x)/2;
    end for;
  end root;
  Real y = root(40 + 2*time);
  annotation(experiment(StopTime = 1));
end Roots;

//@ case assertion_in_a_branch_that_is_not_taken
//@ run stop=1
// Calls that are not active check nothing.
model Roots
  function root
    input Real a;
    output Real x = 1 + a;
  algorithm
    assert(a > 0, "there is no root");
    for k in 1:1000 loop
      x := (x + a/x)/2;
    end for;
  end root;
  Real y[40] = {if noEvent(k > 20*time) then root(k - 20*time) else 0 for k in 1:40};
end Roots;
//@ expect y[9], y[20], y[36] = 0, 0, 4 rel 1e-14

//@ case discrete_fields_of_computed_records
//@ run stop=2 tolerance=1e-8
// The phase of a medium is an Integer that a function computes: it changes at the events of its comparisons.
package Media
  record State
    Real h;
    Integer phase;
  end State;
  function setState
    input Real h;
    output State state;
  protected
    Integer phase = if h > 1 and h < 3 then 2 else 1;
  algorithm
    state := State(h, phase);
  end setState;
  model Heated
    State bound = setState(2*time);
    State equated;
    Real h = 0.6 + time;
  equation
    equated = setState(h^2);
  end Heated;
end Media;
//@ expect bound.phase at 0.4, 1, 1.8 = 1, 2, 1
//@ expect equated.phase at 0.3, 1, 1.5 = 1, 2, 1
//@ expect events = 4

//@ case arguments_of_operators_are_counted
//@ check
model Counts
  //@ error[MO0219] 12-31
  Real h = homotopy(time, 1, 2);
  //@ error[MO0219] 12-18
  Real f = fill(1);
  //@ error[MO0219] 14-31
  String s = getInstanceName(1);
  //@ error[MO0212] 22-31
  Real b = smooth(0, time > 0.5);
equation
  //@ error[MO0219] 3-44
  assert(true, "a", AssertionLevel.error, 1);
  when time > 0.8 then
    //@ error[MO0219] 5-23
    terminate("a", "b");
  end when;
  when time > 0.9 then
    //@ error[MO0212] 15
    terminate(3);
  end when;
end Counts;
