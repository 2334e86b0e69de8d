within Effects;
model DahlPresliding "Friction of elastic bristles without Stribeck effect"
  //   f = -F z,   delta dz/dt = v - |v| z
  // Over the path s from rest the force rises as F (1 - exp(-s/delta)), with the initial stiffness sigma_0 = F/delta.
  // The state z is the force relative to F, so F = 0 is regular. Its relaxation time delta/|v| is short only while
  // the body moves fast, where z stays at +-1.
  // Source: Dahl (1968), "A solid friction model", Aerospace Corporation TOR-0158(3107-18)-1, with exponent 1.
  extends PartialDrag;
  parameter Units.Force  F     = 0     "Friction after a long path";
  parameter Units.Length delta = 10e-6 "Path after which 63 % of it acts";

  Units.Fraction        z(start = 0, fixed = true) "Force relative to F, -1 to 1";
  Units.SpringStiffness sigma_0                    "Initial stiffness";
equation
  delta*der(z) = v - noEvent(abs(v))*z;
  f = -F*z;
  sigma_0 = F/delta;

  annotation(__mocc(
    effect   = "amplitude=F>0; delta=5e-6,20e-6,80e-6",
    law      = "f = -F z",
    explains = "Friction with an elastic beginning acts on %at."));
end DahlPresliding;
