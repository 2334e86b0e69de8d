within Effects;
model RootOutflow "Flow to the outside with the square root of the potential"
  //   f = k e/sqrt(|e| + delta)
  // The turbulent leak of a tank (Torricelli's law) or of a pipe (Bernoulli's law). delta, a potential that is small
  // compared with everything, makes the slope at 0 finite.
  extends PartialOutflow;
  parameter Real k     = 0    "Flow per root of the potential, in their units";
  parameter Real delta = 1e-6 "Potential below which the flow is proportional to it";
equation
  f = k*e/sqrt(noEvent(abs(e)) + delta);

  annotation(__mocc(
    effect   = "amplitude=k>0; delta=1e-4*span(e)",
    law      = "f = k sign(e) sqrt(|e|)",
    explains = "A flow that grows with the square root of the potential leaves the model at %at."));
end RootOutflow;
