within Thermal;
model Radiation "Heat exchange by radiation"
  //   Q_flow = sigma A (T_a^4 - T_b^4)
  // Stefan and Boltzmann's law; sigma = 5.670374e-8 W/(m2.K4).
  parameter Units.Area A "Area, times the emissivity";

  Units.HeatFlowRate Q_flow "Heat flow from a to b";

  HeatPort port_a;
  HeatPort port_b;
equation
  Q_flow = stefanBoltzmann*A*(port_a.T^4 - port_b.T^4);
  port_a.Q_flow = Q_flow;
  port_b.Q_flow = -Q_flow;
end Radiation;
