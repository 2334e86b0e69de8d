within Effects;
model RootBypass "Flow past a component with the square root of the difference of the potentials"
  //   f = k de/sqrt(|de| + delta)
  // A turbulent leak past a valve or a piston (Bernoulli's law). delta, a difference that is small compared with
  // everything, makes the slope at 0 finite.
  extends PartialBypass;
  parameter Real k     = 0    "Flow per root of the difference, in their units";
  parameter Real delta = 1e-6 "Difference below which the flow is proportional to it";
equation
  f = k*de/sqrt(noEvent(abs(de)) + delta);

  annotation(__mocc(
    effect   = "amplitude=k; delta=1e-4*span(de)",
    law      = "f = k sign(de) sqrt(|de|)",
    explains = "A flow that grows with the square root of the difference of the potentials passes %at."));
end RootBypass;
