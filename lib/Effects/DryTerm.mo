within Effects;
model DryTerm "Dry friction as a term"
  //   term = -F z,   delta dz/dt = x - |x| z;   |term| = F while x moves,   |term| <= F at rest
  // z is the share of the friction that acts. It reverses while x has been integrated over delta, and keeps its value at
  // rest, so a state that is stuck stays where it is; delta is small compared with the integrals of the record.
  // Source: Dahl (1968), "A solid friction model", Aerospace Corporation TOR-0158(3107-18)-1, with exponent 1.
  extends PartialTermOver;
  parameter Real F     = 0    "Friction while x moves, in the unit of the equation";
  parameter Real delta = 1e-6 "Integral of x after which 63 % of the friction has reversed";

  Real moved(start = 0, fixed = true)           "Integral of x";
  Units.Fraction z(start = 0, fixed = true) "Share of the friction that acts, -1 to 1";
equation
  der(moved) = x;
  delta*der(z) = x - noEvent(abs(x))*z;
  term = -F*z;

  annotation(__mocc(
    effect   = "adds=term; of=speed; amplitude=F>0; delta=1e-5*span(moved)",
    law      = "-F sign(x)",
    explains = "The equation of %at lacks dry friction: a term of constant size against the motion."));
end DryTerm;
