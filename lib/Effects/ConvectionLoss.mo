within Effects;
model ConvectionLoss "Heat loss by natural convection"
  //   Q_flow = -k dT |dT|^(1/4),   dT = T - T_0
  // The warmer the body, the faster the air around it rises: the heat transfer coefficient grows with the fourth root of
  // the difference (laminar natural convection). Below dT_min the law becomes linear.
  // Source: VDI Heat Atlas, 2nd ed. (2010), chapter F2.
  extends PartialHeatLoss;
  parameter Real k(unit = "W/K1.25") = 0 "Coefficient of the heat flow";
  parameter Units.TemperatureDifference dT_min = 0.01 "Difference below which the law becomes linear";
equation
  Q_flow = -k*dT*(dT^2 + dT_min^2)^0.125;

  annotation(__mocc(
    effect   = "amplitude=k>0; T_0=min(T),293.15",
    law      = "Q_flow = -k dT |dT|^(1/4)",
    explains = "%at loses heat by convection that grows with the difference to its surroundings."));
end ConvectionLoss;
