within Effects;
partial model PartialHeat "Heat flow into a body"
  Units.Temperature  T      "Temperature";
  Units.HeatFlowRate Q_flow "Heat flow into what is connected";

  Thermal.HeatPort port "Where it enters";
equation
  T = port.T;
  port.Q_flow = -Q_flow;
end PartialHeat;
