within Pneumatics;
model GivenPressure "Air at a given pressure, such as a recorded one"
  input Units.PressureDifference p_gauge "Pressure above ambient";
  Port port;
equation
  port.p = Air.p_ambient + p_gauge;
end GivenPressure;
