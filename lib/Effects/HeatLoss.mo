within Effects;
model HeatLoss "Heat loss to the surroundings, proportional to the excess temperature"
  //   Q_flow = -G (T - T_0)
  // Newton's law of cooling, with surroundings that the model does not have. A body with the heat capacity C and this
  // loss alone cools as exp(-G t/C).
  extends PartialHeatLoss;
  parameter Units.ThermalConductance G = 0 "Heat flow per excess temperature";
equation
  Q_flow = -G*dT;

  annotation(__mocc(
    effect   = "amplitude=G>0; T_0=min(T),293.15",
    law      = "Q_flow = -G (T - T_0)",
    explains = "%at loses heat to its surroundings."));
end HeatLoss;
