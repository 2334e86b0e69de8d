within Effects;
model LinearBypass "Flow past a component in proportion to the difference of the potentials"
  //   f = k de
  // A laminar leak past a valve or a piston, a parallel conductance, diffusion.
  extends PartialBypass;
  parameter Real k = 0 "Flow per difference of the potentials, in their units";
equation
  f = k*de;

  annotation(__mocc(
    effect   = "amplitude=k",
    law      = "f = k de",
    explains = "A flow proportional to the difference of the potentials passes %at."));
end LinearBypass;
