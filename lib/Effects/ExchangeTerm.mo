within Effects;
model ExchangeTerm "Exchange with surroundings as a term"
  //   term = -a (x - x_0)
  // Newton's law of cooling for a temperature; the same law holds for leakage to a constant level.
  extends PartialTermOver;
  parameter Real a   = 0 "Factor of the difference";
  parameter Real x_0 = 0 "Value of the surroundings";
equation
  term = -a*(x - x_0);

  annotation(__mocc(
    effect   = "adds=term; of=state; amplitude=a>0; x_0=min(x),0",
    law      = "-a (x - x_0)",
    explains = "The equation of %at lacks an exchange with surroundings."));
end ExchangeTerm;
