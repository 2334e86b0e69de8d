within Effects;
block SensorMagnitude "Sensor that does not see the sign, as one that counts pulses"
  // y = (1 - m) u + m |u|: with m = 1 what it says is the magnitude.
  parameter Units.Fraction m = 0 "Share of the sign that is lost";

  input Real  u "What is measured, in any unit";
  output Real y "What the sensor says, in the same unit";
equation
  y = (1 - m)*u + m*noEvent(abs(u));

  annotation(__mocc(
    effect   = "amplitude=m>0",
    explains = "The sensor of %at does not see the sign."));
end SensorMagnitude;
