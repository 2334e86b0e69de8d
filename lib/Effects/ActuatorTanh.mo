within Effects;
block ActuatorTanh "Actuator that does not follow large values, as a hyperbolic tangent"
  //   y = tanh(sqrt(k) u)/sqrt(k)
  // The value that acts approaches 1/sqrt(k) on either side, sooner than that of ActuatorSaturation.
  extends PartialActuator;
  parameter Real k = 0 "One over the square of the largest value, in the unit of 1/u^2";
protected
  Real x = k*u^2 "Square of the argument";
equation
  // The function of x is smooth where x is zero.
  y = u*noEvent(if x > 1e-6 then tanh(sqrt(x))/sqrt(x) else 1 - x/3 + 2*x^2/15);

  annotation(__mocc(
    effect   = "acts=y; amplitude=k>0",
    law      = "y = tanh(sqrt(k) u)/sqrt(k)",
    explains = "The signal %at acts with saturation."));
end ActuatorTanh;
