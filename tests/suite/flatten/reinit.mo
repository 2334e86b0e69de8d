//@ case two_when_equations
model Twice
  Real x(start = 1, fixed = true);
equation
  der(x) = 1;
  when x > 1.5 then
    reinit(x, -1);
  end when;
  //@ error[MO0254] 3-
  when x > 1.5 then
    reinit(x, -2);
  end when;
end Twice;

//@ case branches_of_one
//@ run stop=1
model Once
  Real x(start = 1, fixed = true);
equation
  der(x) = 1;
  when x > 1.5 then
    reinit(x, -1);
  elsewhen x > 3 then
    reinit(x, -2);
  end when;
end Once;
//@ expect x = -0.5 abs 1e-6

//@ case conditions_without_events
model Frozen
  function f
    input Real u;
    output Boolean y = u > 0.5;
  end f;
  Real x(start = 0, fixed = true);
  //@ error[MO0247] 15-30
  Boolean b = noEvent(x > 0.5);
  //@ error[MO0247] 15-35
  Integer i = noEvent(integer(3*x));
  Integer m(start = 0, fixed = true);
  Integer p(start = 0, fixed = true);
  // At instants only, it does not matter.
  Boolean c = noEvent(pre(b));
equation
  der(x) = 1;
  //@ error[MO0247] 8-23
  when noEvent(x > 0.5) then
    m = 1;
  end when;
  //@ error[MO0247] 8-11
  when f(x) then
    p = 1;
  end when;
end Frozen;

//@ case twice_in_a_branch
model Jumps
  Real x[2](each start = 0, each fixed = true);
  Real y(start = 0, fixed = true), z(start = 0, fixed = true);
equation
  der(x) = {1, 1};
  der(y) = 1;
  der(z) = 1;
  //@ error[MO0254] 3-
  when time > 0.5 then
    reinit(x, {1, 2});
    reinit(x[1], 3);
    if z > 0.2 and z < 0.4 then
      reinit(y, 5);
    elseif z > 0.3 then
      reinit(y, 6);
    else
      reinit(y, 7);
    end if;
  end when;
end Jumps;
