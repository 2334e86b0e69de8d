within Thermal;
model HeatCapacity "Body with a uniform temperature"
  //   C dT/dt = Q_flow
  parameter Units.HeatCapacity C                "Heat capacity";
  parameter Units.Temperature  T_start = 293.15 "Temperature at the start";

  Units.Temperature T(start = T_start, fixed = true, stateSelect = StateSelect.prefer) "Temperature";

  HeatPort port;
equation
  C*der(T) = port.Q_flow;
  port.T = T;
end HeatCapacity;
