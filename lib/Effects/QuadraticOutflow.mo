within Effects;
model QuadraticOutflow "Flow to the outside with the square of the potential"
  //   f = k |e| e
  // A reaction of second order, or a drag.
  extends PartialOutflow;
  parameter Real k = 0 "Flow per square of the potential, in their units";
equation
  f = k*noEvent(abs(e))*e;

  annotation(__mocc(
    effect   = "amplitude=k>0",
    law      = "f = k |e| e",
    explains = "A flow that grows with the square of the potential leaves the model at %at."));
end QuadraticOutflow;
