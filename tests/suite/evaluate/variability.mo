//@ case variability_of_bindings
model Bindings
  parameter Real p = 1;
  //@ error[MO0268] 23
  constant Real c = 2*p;
  Real x = time;
  //@ error[MO0268] 22-26
  parameter Real q = x + 1;
  parameter Real r = p + c;
  constant Integer n = size({p, p}, 1);
  //@ error[MO0248] 21
  discrete Real d = 1;
  //@ error[MO1226] 16-21
  Real slope = der(d);
  parameter Integer k = 3;
  //@ error[MO1226] 15-20
  Real rate = der(k);
end Bindings;

//@ case events_need_discrete_variables
model Discrete
  function above
    input Real x;
    output Boolean y;
  algorithm
    y := x > 0.5;
  end above;
  record Level
    Real x;
    //@ error[MO0247] 20-26
    Boolean high = x > 0.5;
  end Level;
  Boolean event = time > 0.5;
  //@ error[MO0247] 21-31
  Boolean through = above(time);
  Level filled = Level(time);
  Boolean quiet;
  //@ error[MO0248] 24
  discrete Real held = 1;
equation
  //@ error[MO0247] 3-29
  quiet = noEvent(time > 0.7);
end Discrete;

//@ case string_that_changes
// Strings are compared at events; a String of a continuous value is allowed only in messages.
model Gauge
  Real p(start = 1, fixed = true);
  Integer n = if time > 0.5 then 2 else 1;
  //@ error[MO0268] 28-45
  parameter String shown = "p = " + String(p);
  Boolean low = "n = " + String(n) == "n = 1";
  //@ error[MO0247] 19-34
  Boolean whole = String(p) == "1";
equation
  der(p) = -p;
  assert(p < 2, shown + " is too much after " + String(time) + " s");
end Gauge;

//@ case attributes_that_change
// Attributes are as constant as parameters.
model Changing
  //@ error[MO0274] 18
  Real x(start = x);
  //@ error[MO0274] 34
  //@ error[MO0274] 43-46
  Real y(fixed = true, nominal = x, min = time);
  Real z(start = p);
  parameter Real p = 2;
equation
  der(x) = -1;
  der(y) = x;
  der(z) = x;
end Changing;

//@ case records_that_refer_to_each_other
// The data of a plant depend on its configuration, of which one part depends on the data: field by field there is no cycle.
package Plant
  record Configuration
    parameter Integer pumps;
    parameter Integer valves;
  end Configuration;
  record Data
    parameter Configuration configuration;
    parameter Integer zones = 3;
    parameter Real flows[configuration.pumps] = fill(2.0, configuration.pumps);
  end Data;
  model Machine
    parameter Data data;
    parameter Configuration configuration(final pumps = 2, final valves = control.valves);
    Control control(final zones = data.zones);
    Real y[configuration.pumps] = data.flows;
  end Machine;
  model Control
    parameter Integer zones;
    parameter Integer valves = 2*zones;
  end Control;
  model System
    parameter Data data(final configuration = machine.configuration);
    Machine machine(final data = data);
    Real v[machine.configuration.valves] = fill(time, machine.configuration.valves);
  end System;
end Plant;
//@ expect machine.y[2] = 2
//@ expect v[6] = 1

//@ case values_that_change_unseen
// `sign` makes no event, nor does a function or a loop whose trip count is known at run time only.
model Hidden
  function count
    input Real t;
    output Integer n;
  algorithm
    n := 0;
    while n < t loop
      n := n + 1;
    end while;
  end count;
  Real x = time - 0.5;
  //@ error[MO0247] 15-21
  Integer i = sign(x);
  //@ error[MO0247] 15-50
  Integer j = abs(if noEvent(x > 0) then 3 else 1);
  Integer k, l, m, q;
  Boolean c;
algorithm
  //@ error[MO0247] 3-20
  k := count(3*time);
algorithm
  l := 0;
  //@ error[MO0247] 3-
  for i in 1:count(3*time) loop
    l := l + 1;
  end for;
algorithm
  m := 0;
  //@ error[MO0247] 3-39
  if noEvent(x > 0) then m := 1; end if;
  // With an event, it may.
  if x > 0 then c := true; else c := false; end if;
equation
  if noEvent(x > 0) then
    //@ error[MO0247] 5-9
    q = 1;
  else
    q = 2;
  end if;
end Hidden;

//@ case attributes_of_types
model Lengths
  //@ error[MO0289] 29-33
  type T = Real(unit = "m", strat = 3);
  type U = T(start = 2);
  T t(fixed = true);
  U u;
equation
  der(t) = 1;
  u = t;
end Lengths;

//@ case comparisons_of_discrete_values_that_change_between_events
//@ check
model Unseen
  //@ error[MO0309] 11
  Boolean b = noEvent(time > 0.5) == true;
  //@ error[MO0309] 11
  Boolean c = sign(time - 0.5) == 1;
end Unseen;
//@ expect messages lacks "Real"
