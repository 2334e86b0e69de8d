within Effects;
block SensorOffset "Sensor with a wrong zero"
  //   y = u + offset
  parameter Real offset = 0 "Reading at u = 0, in the unit of u";

  input Real  u "Simulated value, in any unit";
  output Real y "Reading, in the same unit";
equation
  y = u + offset;

  annotation(__mocc(
    effect   = "amplitude=offset",
    law      = "y = u + offset",
    explains = "The sensor of %at has an offset."));
end SensorOffset;
