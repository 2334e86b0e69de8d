within Effects;
partial model PartialHeatLoss "Heat that a body loses to surroundings that the model does not have"
  extends PartialHeat;
  parameter Units.Temperature T_0 = 293.15 "Temperature of the surroundings";

  Units.TemperatureDifference dT "Excess over the surroundings";
equation
  dT = T - T_0;
end PartialHeatLoss;
