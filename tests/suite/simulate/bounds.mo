//@ case values_beyond_their_bounds
//@ run stop=3 interval=0.5
// Values beyond their bounds are warned of once.
model Tank
  type Level = Real(min = 0);
  parameter Real area(min = 0.1, max = 10) = 1;
  //@ warning[MO0919] 18-23
  parameter Real outlet(max = area) = 2*area;
  Level h(start = 1, fixed = true);
  //@ warning[MO0919] 8-12
  Real empty(max = 0.5) = 1 - h;
  //@ warning[MO0919] 8-12
  Real depth(min = -0.75, max = 1) = -h;
  Real other(min = -1) = sin(10*time);
equation
  area*der(h) = -0.4;
end Tank;
//@ expect messages has 1 "parameter `outlet` is 2, above its `max` of 1"
//@ expect messages has 1 "at time 0 s `depth` is -1, below its `min` of -0.75"
//@ expect messages has 1 "at time 1.5 s `empty` is 0.6"

//@ case parameter_beyond_its_bounds
//@ run stop=3 interval=0.5 set=area=20 set=outlet=1
model Tank
  type Level = Real(min = 0);
  //@ warning[MO0919] 18-21
  parameter Real area(min = 0.1, max = 10) = 1;
  parameter Real outlet(max = area) = 2*area;
  Level h(start = 1, fixed = true);
  Real empty(max = 0.5) = 1 - h;
  //@ warning[MO0919] 8-12
  Real depth(min = -0.75, max = 1) = -h;
  Real other(min = -1) = sin(10*time);
equation
  area*der(h) = -0.4;
end Tank;
//@ expect messages has 1 "parameter `area` is 20, above its `max` of 10"
