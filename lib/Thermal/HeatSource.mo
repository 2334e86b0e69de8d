within Thermal;
model HeatSource "Heater with a power given by an input"
  input Units.HeatFlowRate Q_flow "Power, negative for a cooler";
  HeatPort port;
equation
  port.Q_flow = -Q_flow;
end HeatSource;
