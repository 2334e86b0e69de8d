within Effects;
block SensorOffset "Sensor whose zero is wrong"
  // y = u + offset.
  parameter Real offset = 0 "Reading at u = 0, in the unit of u";

  input Real  u "What is measured, in any unit";
  output Real y "What the sensor says, in the same unit";
equation
  y = u + offset;

  annotation(__mocc(
    effect   = "amplitude=offset",
    explains = "The sensor of %at has an offset."));
end SensorOffset;
