within Effects;
model RateVariation "A parameter that differs between rise and fall"
  //   p = p_0 (1 + a tanh(x/x_0))
  // A time constant of heating and another one of cooling, a damper that extends more easily than it retracts, a valve that
  // opens faster than it closes: x is the rate of a state. Below x_0, a small share of its range, one value passes into the
  // other.
  extends PartialVariation;
  parameter Units.Fraction a   = 0 "Half the relative difference";
  parameter Real           x_0 = 1 "Rate at which the difference has developed";
equation
  factor = 1 + a*tanh(x/x_0);

  annotation(__mocc(
    effect   = "varies=factor; follows=line; of=rate; amplitude=a; x_0=0.01*span(x)",
    law      = "1 + a tanh(x/x_0)",
    explains = "The value of %at differs by the sign of %over."));
end RateVariation;
