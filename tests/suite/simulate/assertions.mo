//@ case during_the_run
//@ status 3
model Heater
  Real T(start = 300, fixed = true);
equation
  der(T) = 100;
  //@ error[MO0912] 3-74
  assert(T < 350, "Heater: the temperature leaves the range of the table");
end Heater;

//@ case in_a_component
//@ error[MO0912] at lib/Pneumatics/PartialRestriction.mo:16:3-91
//@ status 3
model Valve
  Pneumatics.Source      supply(p = 7e5);
  Pneumatics.Restriction line(C = 1e-9, b = 1.3);
  Pneumatics.Volume      vessel(V_0 = 1e-3);
equation
  connect(supply.port, line.port_a);
  connect(line.port_b, vessel.port);
end Valve;

//@ case in_an_initial_algorithm
//@ status 3
// Assertions of an initial section are checked once initialization has found the values.
model Filled
  Real p(start = 1);
initial equation
  p^2 = 2;
initial algorithm
  //@ error[MO0912] 3-86
  assert(p > 2, "the volume begins with " + String(p, significantDigits = 4) + " bar");
equation
  der(p) = -p;
end Filled;

//@ case before_initialization
//@ status 3
// The assertion comes before the equation that has no solution for this parameter.
model Root
  parameter Real p = -4;
  Real x(start = 1);
equation
  //@ error[MO0912] 3-42
  assert(p >= 0, "p must not be negative");
  x^2 = p;
end Root;

//@ case in_a_loop
//@ status 3
// An assertion in a loop whose length is known only at run time.
model Newton
  function root
    input Real a;
    output Real x = 1;
  protected
    Integer turns = 0;
  algorithm
    while abs(x*x - a) > 1e-12 loop
      turns := turns + 1;
      //@ error[MO0906] 7-64
      assert(turns < 4, "no root of " + String(a) + " is found");
      x := (x + a/x)/2;
    end while;
  end root;
  Real y = root(4 + time);
  annotation(experiment(StopTime = 3));
end Newton;

//@ case in_a_recursion
//@ status 3
// An assertion in a recursive function, with a message that is built at run time.
model Halves
  function steps
    input Real x;
    input Integer most;
    output Integer n = 0;
  algorithm
    //@ error[MO0906] 5-50
    assert(most > 0, "no end at x = " + String(x));
    if abs(x) > 0.1 then
      n := 1 + steps(x/2, most - 1);
    end if;
  end steps;
  Integer n(start = 0, fixed = true);
equation
  when {initial(), sample(0.5, 0.5)} then
    n = noEvent(steps(1 + 7*time, 3));
  end when;
end Halves;

//@ case subscript_out_of_range
//@ status 3
// A subscript known only at run time leaves the array.
model Gearbox
  parameter Real ratios[3] = {4, 2, 1};
  discrete Integer gear(start = 1, fixed = true);
  Real ratio;
equation
  //@ error[MO0912] 18-21
  ratio = ratios[gear];
  when sample(1, 1) then
    gear = pre(gear) + 1;
  end when;
  annotation(experiment(StopTime = 10));
end Gearbox;

//@ case in_a_long_loop
//@ status 3
// The trip count is known only at run time, and checking takes a loop of its own: iteration 1000 fails.
model Sums
  function divisors
    input Integer n;
    output Integer count = 0;
  algorithm
    for k in 1:n loop
      if mod(n, k) == 0 then
        count := count + 1;
      end if;
    end for;
  end divisors;
  function total
    input Integer n;
    input Real x;
    input Real limit;
    output Real sum = 0;
  algorithm
    for i in 1:n loop
      sum := sum + x*i;
      //@ error[MO0912] 7-117
      assert(i <> 1000 or divisors(i) <> 16 or sum < limit, "iteration " + String(i) + " of " + String(n) + " fails");
    end for;
  end total;
  Real s(start = 0, fixed = true);
  Integer n = integer(1200.5 + time);
  Real y = total(n, 1 + time, 300000*s);
equation
  der(s) = -1;
  annotation(experiment(StopTime = 1));
end Sums;

//@ case in_a_long_loop_that_holds
// The same assertion holds, and what it reads is no unknown of the equation that calls the function.
model Sums
  function divisors
    input Integer n;
    output Integer count = 0;
  algorithm
    for k in 1:n loop
      if mod(n, k) == 0 then
        count := count + 1;
      end if;
    end for;
  end divisors;
  function total
    input Integer n;
    input Real x;
    input Real limit;
    output Real sum = 0;
  algorithm
    for i in 1:n loop
      sum := sum + x*i;
      assert(i <> 1000 or divisors(i) <> 16 or sum < limit, "iteration " + String(i) + " of " + String(n) + " fails");
    end for;
  end total;
  Integer n = integer(1100.5 + time);
  Real y = total(n, 1 + time, y + 1);
  annotation(experiment(StopTime = 1, Interval = 0.25));
end Sums;
// (1 + t) (1 + 2 + ... + n)
//@ expect each y = (1 + time)*n*(n + 1)/2 rel 1e-12
//@ expect n = 1101

//@ case warning_in_a_long_loop
// A warning of a loop whose trip count is known only at run time; the run goes on.
model Sums
  function total
    input Integer n;
    input Real x;
    output Real sum = 0;
  algorithm
    for i in 1:n loop
      sum := sum + x*i;
      //@ warning[MO0912] 7-93
      assert(i < 1000, "iteration " + String(i) + " is late", level = AssertionLevel.warning);
    end for;
  end total;
  Integer n = integer(1200.5 + time);
  Real y = total(n, 1 + time);
  annotation(experiment(StopTime = 0.25, Interval = 0.05));
end Sums;
//@ expect y at start = 1200*1201/2

//@ case in_a_branch_that_is_not_taken
// The inner condition depends on a parameter, the outer one is known only at run time.
package Branches
  model Transfer
    parameter Real eta = 1;
    input Real u;
    Real y;
  equation
    if noEvent(u >= 0) then
      y = eta*u;
    else
      if noEvent(eta > 0) then
        y = u/eta;
      else
        y = 0;
        assert(false, "not defined");
      end if;
    end if;
  end Transfer;
  model Top
    Transfer t(eta = 0, u = time);
  end Top;
end Branches;
//@ expect t.y = 0
