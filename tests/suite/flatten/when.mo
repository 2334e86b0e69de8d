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
