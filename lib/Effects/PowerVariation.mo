within Effects;
model PowerVariation "A parameter that follows a power of a variable"
  //   p = p_0 (|x|/x_0)^e
  // A rate of the order e, a conductance of natural convection, an opening that narrows with the flow. Below one
  // hundredth of x_0, the factor stays that of one hundredth.
  extends PartialVariation;
  parameter Real e   = 0 "Exponent";
  parameter Real x_0 = 1 "Magnitude of x at which the parameter is itself";

  Real size_of_x "Magnitude of x";
equation
  size_of_x = noEvent(abs(x));
  factor = exp(e*log(noEvent(max(size_of_x/x_0, 0.01))));

  annotation(__mocc(
    effect   = "varies=factor; amplitude=e; x_0=max(size_of_x)",
    law      = "(|x|/x_0)^e",
    explains = "The value of %at follows a power of %over."));
end PowerVariation;
