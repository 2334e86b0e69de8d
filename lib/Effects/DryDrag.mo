within Effects;
model DryDrag "Dry friction on a flange"
  //   f = -F z,   delta dz/dt = v - |v| z;   |f| = F while sliding,   |f| <= F at rest
  // Coulomb's law for bodies whose own model has no friction. z is the share of the friction that acts. It reverses
  // within the distance delta and keeps its value at rest, so a stuck body stays where it is; delta is small compared
  // with the strokes of the record.
  // Source: Dahl (1968), "A solid friction model", Aerospace Corporation TOR-0158(3107-18)-1, with exponent 1.
  extends PartialDrag;
  parameter Units.Force  F     = 0    "Friction while sliding";
  parameter Units.Length delta = 1e-6 "Distance after which 63 % of the friction has reversed";

  Units.Fraction z(start = 0, fixed = true) "Share of the friction that acts, -1 to 1";
equation
  delta*der(z) = v - noEvent(abs(v))*z;
  f = -F*z;

  annotation(__mocc(
    effect   = "amplitude=F>0; delta=1e-5*span(s)",
    law      = "f = -F z",
    explains = "Dry friction brakes %at, and holds it at rest."));
end DryDrag;
