within Effects;
partial model PartialHeatExchange "Heat flow between two ports, in addition to existing ones"
  Units.Temperature           T_a    "Temperature at a";
  Units.Temperature           T_b    "Temperature at b";
  Units.TemperatureDifference dT     "T_a - T_b";
  Units.HeatFlowRate          Q_flow "Heat flow from a to b";

  Thermal.HeatPort port_a;
  Thermal.HeatPort port_b;
equation
  T_a = port_a.T;
  T_b = port_b.T;
  dT = T_a - T_b;
  port_a.Q_flow = Q_flow;
  port_b.Q_flow = -Q_flow;
end PartialHeatExchange;
