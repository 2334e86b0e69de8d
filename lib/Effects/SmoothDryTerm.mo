within Effects;
model SmoothDryTerm "Dry friction that vanishes at rest, as a term"
  //   term = -F tanh(x/x_0)
  // Coulomb's law with its jump rounded off: under load, x creeps instead of resting. The power of the term is never
  // positive.
  // Source: Andersson, Söderberg and Björklund (2007), "Friction models for sliding dry, boundary and mixed lubricated
  // contacts", Tribology International 40(4).
  extends PartialTermOver;
  parameter Real F   = 0    "Friction far from rest, in the unit of the equation";
  parameter Real x_0 = 0.01 "Value of x at which 76 % of it acts";
equation
  term = -F*tanh(x/x_0);

  annotation(__mocc(
    effect   = "adds=term; of=speed; amplitude=F>0; x_0=0.002*span(x),0.02*span(x),0.1*span(x)",
    law      = "-F tanh(x/x_0)",
    explains = "The equation of %at lacks dry friction that vanishes smoothly at rest."));
end SmoothDryTerm;
