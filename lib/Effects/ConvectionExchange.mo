within Effects;
model ConvectionExchange "Natural convection past a component"
  //   Q_flow = k dT |dT|^(1/4),   dT = T_a - T_b
  // The law of ConvectionLoss, between two ports.
  // Source: VDI Heat Atlas, 2nd ed. (2010), chapter F2.
  extends PartialHeatExchange;
  parameter Real k(unit = "W/K1.25") = 0 "Coefficient of the heat flow";
  parameter Units.TemperatureDifference dT_min = 0.01 "Difference below which the law becomes linear";
equation
  Q_flow = k*dT*(dT^2 + dT_min^2)^0.125;

  annotation(__mocc(
    effect   = "amplitude=k>0",
    law      = "Q_flow = k dT |dT|^(1/4)",
    explains = "The heat transfer at %at grows with the difference of the temperatures."));
end ConvectionExchange;
