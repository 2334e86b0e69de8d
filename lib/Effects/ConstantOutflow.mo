within Effects;
model ConstantOutflow "Constant flow to the outside"
  //   f = F
  // A pump, a consumer or a leak that does not depend on the potential.
  extends PartialOutflow;
  parameter Real F = 0 "The flow, in the unit of the connector; negative if it enters";
equation
  f = F;

  annotation(__mocc(
    effect   = "amplitude=F",
    law      = "f = F",
    explains = "A constant flow leaves the model at %at, or enters it there if negative."));
end ConstantOutflow;
