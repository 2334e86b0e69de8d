within Effects;
model SmoothStribeckTerm "Dry friction that is greater at low speed and vanishes at rest, as a term"
  //   term = -(F + F_s exp(-(x/x_s)^2)) tanh(x/x_0)
  // Stribeck's curve with its jump rounded off: under load, x creeps instead of resting.
  // Source: Andersson, Söderberg and Björklund (2007), "Friction models for sliding dry, boundary and mixed lubricated
  // contacts", Tribology International 40(4).
  extends PartialTermOver;
  parameter Real F   = 0    "Friction where x is large, in the unit of the equation";
  parameter Real F_s = 0    "Excess at low speed";
  parameter Real x_s = 1    "Value of x at which 37 % of the excess is left";
  parameter Real x_0 = 0.01 "Value of x at which 76 % of the friction acts";
equation
  term = -(F + F_s*exp(-(x/x_s)^2))*tanh(x/x_0);

  annotation(__mocc(
    effect   = "adds=term; of=speed; amplitude=F>0,F_s>0; x_0=0.002*span(x),0.02*span(x); x_s=0.05*span(x),0.15*span(x); simpler=Effects.SmoothDryTerm",
    law      = "-(F + F_s exp(-(x/x_s)^2)) tanh(x/x_0)",
    explains = "The equation of %at lacks dry friction that is greater at low speed and vanishes at rest."));
end SmoothStribeckTerm;
