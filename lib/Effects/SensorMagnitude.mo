within Effects;
block SensorMagnitude "Sensor that does not see the sign, such as a pulse counter"
  //   y = (1 - m) u + m |u|
  // With m = 1 the sensor reads the magnitude.
  parameter Units.Fraction m = 0 "Share of the sign that is lost";

  input Real  u "Simulated value, in any unit";
  output Real y "Reading, in the same unit";
equation
  y = (1 - m)*u + m*noEvent(abs(u));

  annotation(__mocc(
    effect   = "amplitude=m>0",
    law      = "y = (1 - m) u + m |u|",
    explains = "The sensor of %at does not see the sign."));
end SensorMagnitude;
