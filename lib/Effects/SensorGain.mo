within Effects;
block SensorGain "Sensor whose scale is wrong"
  // y = (1 + g) u.
  parameter Units.Fraction g = 0 "Relative error of the scale";

  input Real  u "What is measured, in any unit";
  output Real y "What the sensor says, in the same unit";
equation
  y = (1 + g)*u;

  annotation(__mocc(
    effect   = "amplitude=g",
    explains = "The scale of the sensor of %at is wrong."));
end SensorGain;
