within Pneumatics;
model GivenPressure "Air at a given pressure, as a recording says it"
  input Units.PressureDifference p_gauge "Pressure above ambient";
  Port port;
equation
  port.p = Air.p_ambient + p_gauge;
end GivenPressure;
