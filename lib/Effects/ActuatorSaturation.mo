within Effects;
block ActuatorSaturation "Actuator that does not follow large values"
  //   y = u/sqrt(1 + k u^2)
  // The value that acts approaches 1/sqrt(k) on either side.
  extends PartialActuator;
  parameter Real k = 0 "One over the square of the largest value, in the unit of 1/u^2";
equation
  y = u/sqrt(1 + k*u^2);

  annotation(__mocc(
    effect   = "acts=y; amplitude=k>0",
    law      = "y = u/sqrt(1 + k u^2)",
    explains = "The signal %at acts with saturation."));
end ActuatorSaturation;
