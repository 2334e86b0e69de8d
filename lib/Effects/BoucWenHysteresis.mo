within Effects;
model BoucWenHysteresis "Hysteresis of an elastic joint: rubber, a bolted joint, a magnetorheological damper"
  //   f = -F z,   delta dz/dt = v - b |v| z - (1 - b) v |z|
  // Over the path s from rest the force rises as F (1 - exp(-s/delta)). On the way back it falls with the stiffness
  // F/delta (1 + (2 b - 1) z): b = 1 is Dahl's friction, and with b = 1/2 the way back begins as stiff as the path from rest.
  // Source: Wen (1976), "Method for random vibration of hysteretic systems", J. Eng. Mech. Div. 102, 249-263, with n = 1.
  extends PartialDrag;
  parameter Units.Force    F     = 0    "Force after a long path";
  parameter Units.Length   delta = 1e-3 "Path after which 63 % of it acts";
  parameter Units.Fraction b     = 0.5  "Share of what opposes the motion in either direction";

  Units.Fraction z(start = 0, fixed = true) "Force relative to F, -1 to 1";
equation
  delta*der(z) = v - b*noEvent(abs(v))*z - (1 - b)*v*noEvent(abs(z));
  f = -F*z;

  annotation(__mocc(
    effect   = "amplitude=F>0; delta=0.02*span(s),0.1*span(s); b=0.5,0.75",
    law      = "f = -F z, delta dz/dt = v - b |v| z - (1 - b) v |z|",
    explains = "An elastic joint with hysteresis holds %at."));
end BoucWenHysteresis;
