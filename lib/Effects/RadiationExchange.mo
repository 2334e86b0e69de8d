within Effects;
model RadiationExchange "Radiation past a component"
  //   Q_flow = sigma A (T_a^4 - T_b^4)
  // Stefan and Boltzmann's law, between two ports.
  extends PartialHeatExchange;
  parameter Units.Area A = 0 "Area, times the emissivity";
equation
  Q_flow = Thermal.stefanBoltzmann*A*(T_a^4 - T_b^4);

  annotation(__mocc(
    effect   = "amplitude=A>0",
    law      = "Q_flow = sigma A (T_a^4 - T_b^4)",
    explains = "Heat is radiated across %at."));
end RadiationExchange;
