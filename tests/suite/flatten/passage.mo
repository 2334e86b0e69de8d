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
  //@ error[MO0326] 31-43: `x` is neither an unconnected `Real` input of the model, nor an output of a component, nor a variable that an equation is solved for
  annotation(__mocc(through = "x = valve.y"));
end Driven;

//@ case a_variable_passes_through_a_component
//@ run stop=1 tolerance=1e-9
block Gain
  parameter Real k = 3;
  input Real u;
  output Real y = k*u;
end Gain;
model Loop
  Real x(start = 1, fixed = true);
  Real u "What is asked for";
  Real power = u^2;
equation
  u = -3*x - 0.5*u;
  der(x) = u;
end Loop;
model Driven
  extends Loop;
  Gain valve(u = u);
  annotation(__mocc(through = "u = valve.y"));
end Driven;
// dx/dt = -6 x; the equation that determines u keeps reading it.
//@ expect x at 1 = 0.0024787521766663585 abs 1e-8
//@ expect u at 0 = -2 abs 1e-9
//@ expect power at 0 = 36 abs 1e-8

//@ case of_two_equations_the_one_without_a_rate_determines
//@ run stop=1 tolerance=1e-9
block Gain
  parameter Real k = 3;
  input Real u;
  output Real y = k*u;
end Gain;
model Mass
  Real s(start = 1, fixed = true), v(start = 0, fixed = true), F;
equation
  der(s) = v;
  F = 2*der(v);
  F = -8*s;
end Mass;
model Driven
  extends Mass;
  Gain weaker(k = 0.25, u = F);
  annotation(__mocc(through = "F = weaker.y"));
end Driven;
// 2 der(v) = -2 s.
//@ expect s at 1 = 0.5403023058681398 abs 1e-7
//@ expect F at 0 = -8 abs 1e-9

//@ case an_output_passes_through_a_component
//@ run stop=1 tolerance=1e-9
connector In = input Real;
connector Out = output Real;
block Controller
  In e;
  Out y;
  Real integral(start = 0, fixed = true);
equation
  der(integral) = y;
  y = 2*e;
end Controller;
block Plant
  In u;
  Out x(start = 1, fixed = true);
equation
  der(x) = u;
end Plant;
block Offset
  input Real u;
  output Real y = u - 1;
end Offset;
model Loop
  Controller controller;
  Plant plant;
equation
  connect(controller.y, plant.u);
  controller.e = -plant.x;
end Loop;
model Driven
  extends Loop;
  Offset offset(u = controller.y);
  annotation(__mocc(through = "controller.y = offset.y"));
end Driven;
// dx/dt = -2 x - 1; inside of the controller, its output is read as it is.
//@ expect plant.x at 1 = -0.2969970751450809 abs 1e-7
//@ expect controller.integral at 1 = -0.2969970751450809 abs 1e-7
