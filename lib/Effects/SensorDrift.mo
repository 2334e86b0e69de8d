within Effects;
block SensorDrift "Sensor whose offset grows with time"
  //   y = u + r t
  extends PartialSensor;
  parameter Real r = 0 "Drift per second, in the unit of u";
equation
  y = u + r*time;

  annotation(__mocc(
    effect   = "amplitude=r",
    law      = "y = u + r t",
    explains = "The sensor of %at drifts."));
end SensorDrift;
