within Effects;
model ExponentialVariation "A parameter that grows exponentially with a variable"
  //   p = p_0 exp(k u),   u = (x - x_lo)/(x_hi - x_lo)
  // A saturation current over the temperature, the viscosity of an oil, a rate that an inhibitor lowers.
  extends PartialVariation;
  parameter Real k    = 0 "Logarithm of the factor from x_lo to x_hi";
  parameter Real x_lo = 0 "Value of x at which the parameter is itself";
  parameter Real x_hi = 1 "Value of x at which the parameter has grown by exp(k)";
equation
  factor = exp(noEvent(max(-50, min(50, k*(x - x_lo)/(x_hi - x_lo)))));

  annotation(__mocc(
    effect   = "varies=factor; follows=line; amplitude=k; x_lo=min(x); x_hi=max(x)",
    law      = "exp(k (x - x_lo)/(x_hi - x_lo))",
    explains = "The value of %at varies exponentially with %over."));
end ExponentialVariation;
