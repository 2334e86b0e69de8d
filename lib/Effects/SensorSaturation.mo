within Effects;
block SensorSaturation "Sensor that reads large values too small"
  //   y = u/sqrt(1 + k u^2)
  // The reading approaches 1/sqrt(k) on either side.
  extends PartialSensor;
  parameter Real k = 0 "One over the square of the largest reading, in the unit of 1/u^2";
equation
  y = u/sqrt(1 + k*u^2);

  annotation(__mocc(
    effect   = "amplitude=k>0",
    law      = "y = u/sqrt(1 + k u^2)",
    explains = "The sensor of %at saturates."));
end SensorSaturation;
