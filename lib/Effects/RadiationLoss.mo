within Effects;
model RadiationLoss "Heat loss by radiation to surroundings that the model does not have"
  //   Q_flow = -sigma A (T^4 - T_0^4)
  // Stefan and Boltzmann's law. To surroundings at 0 K, a body cools as 1/T^3 = 1/T_start^3 + 3 sigma A t/C.
  extends PartialHeatLoss;
  parameter Units.Area A = 0 "Area, times the emissivity";
equation
  Q_flow = -Thermal.stefanBoltzmann*A*(T^4 - T_0^4);

  annotation(__mocc(
    effect   = "amplitude=A>0; T_0=min(T),293.15",
    law      = "Q_flow = -sigma A (T^4 - T_0^4)",
    explains = "%at loses heat by radiation."));
end RadiationLoss;
