within Effects;
model StribeckTerm "Dry friction that is greater at low speed, as a term"
  //   term = -(F + F_s exp(-(x/x_s)^2)) z,   delta dz/dt = x - |x| z
  // Stribeck's curve without its viscous part: F + F_s where x begins to move, F where it is large. z is that of DryTerm.
  // Source: Armstrong-Hélouvry, Dupont and Canudas de Wit (1994), "A survey of models, analysis tools and compensation
  // methods for the control of machines with friction", Automatica 30(7).
  extends PartialTermOver;
  parameter Real F     = 0    "Friction where x is large, in the unit of the equation";
  parameter Real F_s   = 0    "Excess at rest";
  parameter Real x_s   = 1    "Value of x at which 37 % of the excess is left";
  parameter Real delta = 1e-6 "Integral of x after which 63 % of the friction has reversed";

  Real moved(start = 0, fixed = true)       "Integral of x";
  Units.Fraction z(start = 0, fixed = true) "Share of the friction that acts, -1 to 1";
equation
  der(moved) = x;
  delta*der(z) = x - noEvent(abs(x))*z;
  term = -(F + F_s*exp(-(x/x_s)^2))*z;

  annotation(__mocc(
    effect   = "adds=term; of=speed; amplitude=F>0,F_s>0; delta=1e-5*span(moved); x_s=0.02*span(x),0.05*span(x),0.15*span(x); simpler=Effects.DryTerm",
    law      = "-(F + F_s exp(-(x/x_s)^2)) sign(x)",
    explains = "The equation of %at lacks dry friction that is greater at low speed."));
end StribeckTerm;
