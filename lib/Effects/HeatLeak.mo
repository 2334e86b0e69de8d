within Effects;
model HeatLeak "Heat conduction past a component"
  //   Q_flow = G (T_a - T_b)
  // A thermal bridge or a damaged insulation.
  extends PartialHeatExchange;
  parameter Units.ThermalConductance G = 0 "Heat flow per difference of the temperatures";
equation
  Q_flow = G*dT;

  annotation(__mocc(
    effect   = "amplitude=G>0",
    law      = "Q_flow = G (T_a - T_b)",
    explains = "Heat leaks past %at."));
end HeatLeak;
