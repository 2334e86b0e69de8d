within Effects;
model ConstantHeatFlow "Constant heat flow"
  //   Q_flow = P
  // A consumer, friction or sunshine, or, if negative, power of a heater that goes elsewhere.
  extends PartialHeat;
  parameter Units.HeatFlowRate P = 0 "The heat flow into the body";
equation
  Q_flow = P;

  annotation(__mocc(
    effect   = "amplitude=P",
    law      = "Q_flow = P",
    explains = "%at receives a constant heat flow, or loses it if negative."));
end ConstantHeatFlow;
