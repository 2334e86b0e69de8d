within Effects;
model ArrheniusVariation "A parameter that follows Arrhenius' law"
  //   p = p_0 exp(b (1 - x_0/x))
  // A rate or a viscosity over the absolute temperature, with b = E/(R x_0) for the activation energy E. In models without
  // units, a variable that comes close to 0, or changes its sign, is not an absolute temperature: the factor is then 1.
  extends PartialVariation(x(unit = "K"));
  parameter Real b   = 0 "Activation energy, divided by the gas constant and x_0";
  parameter Real x_0 = 1 "Value of x at which the parameter is itself";
  parameter Real x_min = 1 "Least value of x";
equation
  factor = if x_min > 0.1*x_0 then exp(b*(1 - x_0/noEvent(max(x, 0.1*x_0)))) else 1;

  annotation(__mocc(
    effect   = "varies=factor; amplitude=b; x_0=max(x); x_min=min(x)",
    law      = "exp(b (1 - x_0/x))",
    explains = "The value of %at follows Arrhenius' law over %over."));
end ArrheniusVariation;
