within Thermal;
model Ambient "Surroundings with a constant temperature"
  parameter Units.Temperature T = 293.15 "Temperature";
  HeatPort port;
equation
  port.T = T;
end Ambient;
