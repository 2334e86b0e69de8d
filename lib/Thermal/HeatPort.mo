within Thermal;
connector HeatPort "Thermal connection"
  Units.Temperature T "Temperature, the same for all connected components";
  flow Units.HeatFlowRate Q_flow "Heat flow into the component that owns this port";
end HeatPort;
