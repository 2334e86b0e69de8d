//@ case an_input_passes_through_a_component
//@ run stop=1 tolerance=1e-9
block Gain
  parameter Real k = 3;
  input Real u;
  output Real y = k*u;
end Gain;
model Tank
  input Real u(start = 2);
  Real x(start = 0, fixed = true);
equation
  der(x) = u;
end Tank;
model Driven
  extends Tank;
  Gain valve(u = u);
  annotation(__mocc(through = "u = valve.y"));
end Driven;
//@ expect x at 1 = 6 abs 1e-8
//@ expect valve.u at 1 = 2 abs 1e-12

//@ case components_of_one_input_follow_one_another
//@ run stop=1 tolerance=1e-9
block Shifted
  parameter Real by = 1;
  input Real u;
  output Real y;
equation
  y = u + by;
end Shifted;
block Doubled
  input Real u;
  output Real y;
equation
  y = 2*u;
end Doubled;
model Tank
  input Real u(start = 2);
  Real x(start = 0, fixed = true);
  Real copy = u;
equation
  der(x) = u;
end Tank;
model Driven
  extends Tank;
  Shifted first(u = u);
  Doubled second(u = u);
  annotation(__mocc(through = "u = first.y, u = second.y"));
end Driven;
// First 2 + 1, then 2 (2 + 1).
//@ expect x at 1 = 6 abs 1e-8
//@ expect copy at 1 = 6 abs 1e-8
//@ expect second.u at 1 = 3 abs 1e-12

//@ case passages_that_cannot_be
block Gain
  input Real u;
  output Real y = 2*u;
end Gain;
model Driven
  input Real u(start = 0);
  Real x(start = 0, fixed = true);
  Gain valve(u = u);
equation
  der(x) = u;
  //@ error[MO0326] 31-43: `x` is not an unconnected `Real` input of the model
  annotation(__mocc(through = "x = valve.y"));
end Driven;
