within Effects;
model RadiationTerm "Heat radiation as a term"
  //   term = -a (x^4 - x_0^4)
  // The law of Stefan and Boltzmann for a temperature x and surroundings at x_0.
  extends PartialTerm;
  input Units.Temperature x "Temperature";
  parameter Real              a   = 0      "Emitted by unit of x^4, in the unit of the equation";
  parameter Units.Temperature x_0 = 293.15 "Temperature of the surroundings";
equation
  term = -a*(x^4 - x_0^4);

  annotation(__mocc(
    effect   = "adds=term; of=state; amplitude=a>0; x_0=293.15,min(x)",
    law      = "-a (x^4 - x_0^4)",
    explains = "The equation of %at lacks a term for heat radiation."));
end RadiationTerm;
