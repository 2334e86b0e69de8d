within Effects;
block SensorGainFromZero "Sensor with a wrong scale, right at the zero of its unit"
  //   y = u + g (u - u_0)
  // The zero of its unit, 0 degC or the ambient pressure, is another one than that of the simulated value.
  parameter Units.Fraction g   = 0 "Relative error of the scale";
  parameter Real           u_0 = 0 "Value at which the reading is right";

  input Real  u "Simulated value, in any unit";
  output Real y "Reading, in the same unit";
equation
  y = u + g*(u - u_0);

  annotation(__mocc(
    effect   = "amplitude=g; u_0=zero(u); named=Effects.SensorGain",
    law      = "y = u + g (u - u_0)",
    explains = "The scale of the sensor of %at is wrong."));
end SensorGainFromZero;
