//@ case clauses
//@ snapshot flat
// When-clauses, reinit and initial equations stay what they are.
model Ball
  Real h;
  Real v;
  Integer n(start = 0, fixed = true);
initial equation
  h = 1;
  v = 0;
equation
  der(h) = v;
  der(v) = -9.81;
  when h <= 0 then
    reinit(v, -0.8*v);
    n = pre(n) + 1;
  elsewhen {initial(), sample(0, 0.5)} then
    n = 0;
  end when;
end Ball;
//@ expect flat has 2 "when "
//@ expect flat has 1 "reinit("

//@ case reinit_outside_when
model Count
  Integer n(start = 0);
  Real x(start = 0);
equation
  der(x) = 1;
  when x > 0.5 then
    n = n + 1;
  end when;
  //@ error[MO1265] 3-14
  reinit(x, 0);
end Count;

//@ case assignment_to_another_component
model Foreign
  model Counter
    discrete Real count(start = 0);
  end Counter;
  block Display
    input Real shown;
  end Display;
  Counter counter;
  Display display;
equation
  when sample(0, 1) then
    //@ error[MO1275] 5-18
    counter.count = pre(counter.count) + 1;
    //@ error[MO1275] 5-18
    display.shown = time;
  end when;
end Foreign;

//@ case reinit_in_an_algorithm
model Tank
  Real level(start = 0, fixed = true);
equation
  der(level) = 1;
algorithm
  when time > 0.5 then
    //@ error[MO1265] 5-20
    reinit(level, 0);
  end when;
end Tank;

//@ case branches_with_other_left_sides
model Counters
  discrete Real a(start = 0, fixed = true);
  discrete Real b(start = 0, fixed = true);
  Real x(start = 0, fixed = true);
equation
  der(x) = 1;
  when x > 0.2 then
    a = 1;
  //@ error[MO0257] 12-18
  elsewhen x > 0.4 then
    b = 1;
  end when;
end Counters;

//@ case statements_with_other_left_sides
//@ snapshot flat
//@ run stop=1
// A branch of a when-statement keeps what it does not assign, which the flat equations say.
model Counters
  discrete Real a(start = 0, fixed = true);
  discrete Real b(start = 0, fixed = true);
  Real x(start = 0, fixed = true);
equation
  der(x) = 1;
algorithm
  when x > 0.2 then
    a := 1;
  elsewhen x > 0.4 then
    b := 2;
  end when;
end Counters;
//@ expect a = 1 abs 0
//@ expect b = 2 abs 0

//@ case branches_with_equal_left_sides
//@ run stop=1
// `reinit` and `assert` are not equations of a variable, and the order does not matter.
model Counters
  discrete Real a(start = 0, fixed = true);
  discrete Real b(start = 0, fixed = true);
  Real x(start = 0, fixed = true);
equation
  der(x) = 1;
  when x > 0.2 then
    a = 1;
    b = pre(b);
  elsewhen x > 0.9 then
    b = 2;
    a = pre(a) + 1;
    reinit(x, 0);
    assert(time < 2, "late");
  end when;
end Counters;
//@ expect a = 2 abs 0
//@ expect b = 2 abs 0
