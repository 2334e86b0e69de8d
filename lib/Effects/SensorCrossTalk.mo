within Effects;
block SensorCrossTalk "Sensor that also reads a share of another quantity"
  //   y = u + a (x - x_0)
  // A common wire, a common supply, or a sensor that is sensitive to temperature: an offset in proportion to x.
  extends PartialSensor;
  parameter Real a   = 0 "Change of the reading per change of x";
  parameter Real x_0 = 0 "Value of x at which the reading is right";

  input Real x "The other quantity, in any unit";
equation
  y = u + a*(x - x_0);

  annotation(__mocc(
    effect   = "amplitude=a; x_0=min(x),max(x)",
    law      = "y = u + a (x - x_0)",
    explains = "The sensor of %at also reads a share of %over."));
end SensorCrossTalk;
