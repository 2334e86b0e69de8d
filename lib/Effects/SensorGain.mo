within Effects;
block SensorGain "Sensor with a wrong scale"
  //   y = (1 + g) u
  parameter Units.Fraction g = 0 "Relative error of the scale";

  input Real  u "Simulated value, in any unit";
  output Real y "Reading, in the same unit";
equation
  y = (1 + g)*u;

  annotation(__mocc(
    effect   = "amplitude=g",
    law      = "y = (1 + g) u",
    explains = "The scale of the sensor of %at is wrong."));
end SensorGain;
