within Effects;
model LinearOutflow "Flow to the outside in proportion to the potential"
  //   f = k e
  // A laminar leak of a tank or a pipe, a loss, a reaction of first order. A store of capacity C with this outflow alone
  // empties as exp(-k t/C).
  extends PartialOutflow;
  parameter Real k = 0 "Flow per potential, in their units";
equation
  f = k*e;

  annotation(__mocc(
    effect   = "amplitude=k>0",
    law      = "f = k e",
    explains = "A flow proportional to the potential leaves the model at %at."));
end LinearOutflow;
