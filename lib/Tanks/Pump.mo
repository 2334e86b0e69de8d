within Tanks;
model Pump "Pump with a flow proportional to its voltage"
  //   q = k u
  parameter Real k(unit = "m3/(s.V)") = 0.05 "Volume flow per voltage";
  input Units.Voltage u "Voltage";
  Port port;
equation
  port.q = -k*u;
end Pump;
