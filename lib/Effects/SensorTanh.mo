within Effects;
block SensorTanh "Sensor that reads large values too small, as a hyperbolic tangent"
  //   y = tanh(sqrt(k) u)/sqrt(k)
  // The reading approaches 1/sqrt(k) on either side, sooner than that of SensorSaturation.
  extends PartialSensor;
  parameter Real k = 0 "One over the square of the largest reading, in the unit of 1/u^2";
protected
  Real x = k*u^2 "Square of the argument";
equation
  // The function of x is smooth where x is zero.
  y = u*noEvent(if x > 1e-6 then tanh(sqrt(x))/sqrt(x) else 1 - x/3 + 2*x^2/15);

  annotation(__mocc(
    effect   = "amplitude=k>0",
    law      = "y = tanh(sqrt(k) u)/sqrt(k)",
    explains = "The sensor of %at saturates."));
end SensorTanh;
