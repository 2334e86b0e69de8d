within Effects;
model DahlPresliding "Friction of elastic bristles that depends on the path only"
  // f = -F z, delta dz/dt = v - |v| z: from rest the force rises as F (1 - exp(-s/delta)) over the way s. Its
  // stiffness at the beginning is sigma_0 = F/delta. The state z, the force as a share of F, does not know F: with
  // F = 0 nothing is divided by 0. Its relaxation time delta/|v| is short only while the body moves fast, where z
  // stays at +-1. Dahl (1968), "A solid friction model", Aerospace Corporation TOR-0158(3107-18)-1, with exponent 1.
  extends PartialDrag;
  parameter Units.Force  F     = 0     "Friction after a long way";
  parameter Units.Length delta = 10e-6 "Way after which 63 % of it act";

  Units.Fraction        z(start = 0, fixed = true) "Force as a share of F, -1 to 1";
  Units.SpringStiffness sigma_0                    "Stiffness at the beginning of the way";
equation
  delta*der(z) = v - noEvent(abs(v))*z;
  f = -F*z;
  sigma_0 = F/delta;

  annotation(__mocc(
    effect   = "amplitude=F>0; delta=5e-6,20e-6,80e-6",
    explains = "Friction with an elastic beginning acts on %at."));
end DahlPresliding;
