within Effects;
model QuadraticBypass "Flow past a component with the square of the difference of the potentials"
  //   f = k |de| de
  extends PartialBypass;
  parameter Real k = 0 "Flow per square of the difference, in their units";
equation
  f = k*noEvent(abs(de))*de;

  annotation(__mocc(
    effect   = "amplitude=k",
    law      = "f = k |de| de",
    explains = "A flow that grows with the square of the difference of the potentials passes %at."));
end QuadraticBypass;
