within Thermal;
model Conductance "Linear heat conduction or convection"
  //   Q_flow = G (T_a - T_b)
  parameter Units.ThermalConductance G "Heat flow per difference of the temperatures";

  Units.TemperatureDifference dT     "T_a - T_b";
  Units.HeatFlowRate          Q_flow "Heat flow from a to b";

  HeatPort port_a;
  HeatPort port_b;
equation
  dT = port_a.T - port_b.T;
  Q_flow = G*dT;
  port_a.Q_flow = Q_flow;
  port_b.Q_flow = -Q_flow;
end Conductance;
