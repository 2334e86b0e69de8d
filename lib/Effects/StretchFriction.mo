within Effects;
model StretchFriction "Dry friction between two bodies"
  //   f = F z,   delta dz/dt = v_rel - |v_rel| z;   |f| = F while sliding,   |f| <= F at rest
  // The friction of a strut, a bush or a stack of leaf springs. z is the share of it that acts. It reverses within the
  // distance delta and keeps its value at rest; delta is small compared with the deflections of the record.
  // Source: Dahl (1968), "A solid friction model", Aerospace Corporation TOR-0158(3107-18)-1, with exponent 1.
  extends PartialStretchRate;
  parameter Units.Force  F     = 0    "Friction while sliding";
  parameter Units.Length delta = 1e-6 "Distance after which 63 % of the friction has reversed";

  Units.Fraction z(start = 0, fixed = true) "Share of the friction that acts, -1 to 1";
equation
  delta*der(z) = v_rel - noEvent(abs(v_rel))*z;
  f = F*z;

  annotation(__mocc(
    effect   = "between=moving; amplitude=F>0; delta=1e-4*span(s_rel)",
    law      = "f = F z",
    explains = "Dry friction resists the deflection of %at."));
end StretchFriction;
