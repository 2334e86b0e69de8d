//@ case an_output_is_assigned_on_some_paths
//@ check
// The function ends without a value where x is at most 0.5, and returns without one where x is negative.
model Paths
  function limited
    input Real x;
    //@ warning[MO0255] 17
    output Real y;
  algorithm
    if x > 0.5 then
      y := 1;
    end if;
  end limited;
  function early
    input Real x;
    //@ warning[MO0255] 17
    output Real y;
  algorithm
    if x < 0 then
      return;
    end if;
    y := x;
  end early;
  Real a = limited(time);
  Real b = early(time);
end Paths;
//@ expect messages has "some paths through this `if` assign it"

//@ case parts_of_an_output_are_never_assigned
//@ check
model Parts
  record Port
    Real p;
    Real m_flow;
    Real h = 1;
  end Port;
  function first
    input Real x;
    //@ warning[MO0255] 17
    output Real y[2];
  algorithm
    y[1] := x;
  end first;
  function port
    input Real x;
    //@ warning[MO0255] 17
    output Port y;
  algorithm
    y.p := x;
  end port;
  Real a[2] = first(time);
  Port b = port(time);
end Parts;
//@ expect messages has "`Parts.first` may end without a value of its output `y[2]`"
//@ expect messages has "`Parts.port` may end without a value of its output `y.m_flow`"

//@ case outputs_that_are_always_assigned
//@ check
// Every path assigns, fails, or has a loop of which nobody can say that it never runs.
model Always
  type Shape = enumeration(round, square);
  record Port
    Real p;
    Real m_flow;
  end Port;
  function area
    input Shape shape;
    input Real a;
    output Real y;
  algorithm
    if shape == Shape.round then
      y := 3.14*a^2/4;
    elseif shape == Shape.square then
      y := a^2;
    end if;
  end area;
  function checked
    input Real x;
    output Real y;
  algorithm
    if x >= 0 then
      y := sqrt(x);
    else
      assert(false, "x is negative");
    end if;
  end checked;
  function powers
    input Real x;
    input Integer n;
    output Real y[n];
  algorithm
    for i in 1:n loop
      y[i] := x^i;
    end for;
  end powers;
  function port
    input Real x;
    output Port y;
  algorithm
    if x > 0 then
      y.p := x;
      y.m_flow := 1;
    else
      y := Port(p = 0, m_flow = 2);
    end if;
  end port;
  function both
    input Real x;
    output Real y[2, 2];
  algorithm
    y[1, :] := {x, 1};
    y[2, 1] := 2;
    y[2, 2] := 3;
  end both;
  function first
    input Real x;
    output Real y;
  algorithm
    for i in 1:3 loop
      y := i*x;
      break;
    end for;
  end first;
  function default
    input Real x;
    output Real y = 2;
  algorithm
    if x > 0.5 then
      y := 1;
    end if;
  end default;
  Real a = area(Shape.round, time);
  Real b = checked(time);
  Real c[3] = powers(time, 3);
  Port d = port(time);
  Real e[2, 2] = both(time);
  Real g = first(time);
  Real f = default(time);
end Always;
//@ expect messages lacks "MO0255"
