within Effects;
model ArrheniusVariation "A parameter that follows Arrhenius' law"
  //   p = p_0 exp(b (1 - x_0/x))
  // A rate or a viscosity over the absolute temperature, with b = E/(R x_0) for the activation energy E. Below one tenth
  // of x_0, the factor stays that of one tenth.
  extends PartialVariation;
  parameter Real b   = 0 "Activation energy, divided by the gas constant and x_0";
  parameter Real x_0 = 1 "Value of x at which the parameter is itself";

  Real size_of_x "Magnitude of x";
equation
  size_of_x = noEvent(abs(x));
  factor = exp(b*(1 - 1/noEvent(max(x/x_0, 0.1))));

  annotation(__mocc(
    effect   = "varies=factor; amplitude=b; x_0=max(size_of_x)",
    law      = "exp(b (1 - x_0/x))",
    explains = "The value of %at follows Arrhenius' law over %over."));
end ArrheniusVariation;
