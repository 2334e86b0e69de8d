within Effects;
model TwistFriction "Dry friction between two shafts"
  //   tau = M z,   delta dz/dt = w_rel - |w_rel| z;   |tau| = M while slipping,   |tau| <= M at rest
  // A dragging clutch or the friction plates of a damper. z is the share of it that acts. It reverses within the angle delta
  // and keeps its value at rest; delta is small compared with the twists of the record.
  // Source: Dahl (1968), "A solid friction model", Aerospace Corporation TOR-0158(3107-18)-1, with exponent 1.
  extends PartialTwist;
  parameter Units.Torque M     = 0    "Friction while slipping";
  parameter Units.Angle  delta = 1e-4 "Angle after which 63 % of the friction has reversed";

  Units.AngularVelocity w_rel "Difference of the speeds";
  Units.Fraction        z(start = 0, fixed = true) "Share of the friction that acts, -1 to 1";
equation
  w_rel = der(phi_rel);
  delta*der(z) = w_rel - noEvent(abs(w_rel))*z;
  tau = M*z;

  annotation(__mocc(
    effect   = "between=moving; amplitude=M>0; delta=1e-4*span(phi_rel)",
    law      = "tau = M z",
    explains = "Dry friction resists the twist of %at."));
end TwistFriction;
