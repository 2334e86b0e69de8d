within Effects;
model OptimumVariation "A parameter that is greatest, or least, at some value of a variable"
  //   p = p_0 exp(a u + b u^2),   u = (2 x - x_lo - x_hi)/(x_hi - x_lo)
  // Growth over the temperature, the efficiency of a pump over its flow, of a turbine over its speed. The parameter is its
  // own in the middle of the range; with b < 0 the factor is a bell around u = -a/(2 b).
  extends PartialVariation;
  parameter Real a    = 0 "Slope of the logarithm of the factor in the middle";
  parameter Real b    = 0 "Curvature of the logarithm of the factor, halved";
  parameter Real x_lo = 0 "Value of x at which u is -1";
  parameter Real x_hi = 1 "Value of x at which u is 1";
protected
  Real u = (2*x - x_lo - x_hi)/(x_hi - x_lo) "Place in the range";
equation
  factor = exp(noEvent(max(-50, min(50, a*u + b*u^2))));

  annotation(__mocc(
    effect   = "varies=factor; follows=line; amplitude=a,b; x_lo=min(x); x_hi=max(x); simpler=Effects.LinearVariation,Effects.ExponentialVariation",
    law      = "exp(a u + b u^2), u = (2 x - x_lo - x_hi)/(x_hi - x_lo)",
    explains = "The value of %at has an optimum over %over."));
end OptimumVariation;
