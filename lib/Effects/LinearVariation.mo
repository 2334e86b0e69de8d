within Effects;
model LinearVariation "A parameter that grows with a variable"
  //   p = p_0 (1 + a u),   u = (x - x_lo)/(x_hi - x_lo)
  // The annotation `varies` of an amended model says which parameters are multiplied by the factor.
  extends PartialVariation;
  parameter Real a    = 0 "Relative increase from x_lo to x_hi";
  parameter Real x_lo = 0 "Value of x at which the parameter is itself";
  parameter Real x_hi = 1 "Value of x at which the parameter has grown by a";
equation
  factor = 1 + a*(x - x_lo)/(x_hi - x_lo);

  annotation(__mocc(
    effect   = "varies=factor; amplitude=a; x_lo=min(x); x_hi=max(x)",
    law      = "1 + a (x - x_lo)/(x_hi - x_lo)",
    explains = "The value of %at varies linearly with %over."));
end LinearVariation;
