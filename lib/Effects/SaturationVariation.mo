within Effects;
model SaturationVariation "A parameter that falls where a variable is large"
  //   p = p_0/(1 + k (x/x_0)^2)^m
  // The inductance of a coil over its current, the gain of an amplifier over its input. m = 1.5 is the slope of
  // x/sqrt(1 + k x^2).
  extends PartialVariation;
  parameter Units.Fraction k   = 0   "How far the parameter falls at x_0: by the factor (1 + k)^m";
  parameter Real           m   = 1.5 "Exponent";
  parameter Real           x_0 = 1   "Scale of x";

  Real size_of_x = noEvent(abs(x)) "Magnitude of x";
equation
  factor = (1 + k*(x/x_0)^2)^(-m);

  annotation(__mocc(
    effect   = "varies=factor; amplitude=k>0; x_0=max(size_of_x); m=0.5,1.5",
    law      = "(1 + k (x/x_0)^2)^(-m)",
    explains = "The value of %at falls where %over is large."));
end SaturationVariation;
