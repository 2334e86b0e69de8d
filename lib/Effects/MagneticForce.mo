within Effects;
model MagneticForce "Attraction by an end of the stroke"
  //   f = F/(1 + x/d)^2 towards the end
  // x is the distance to the end. The force of a magnet on an armature is inversely proportional to the square of the
  // gap (Maxwell stress B^2/(2 mu_0), B ~ 1/gap); d is the gap that remains at the end, iron included.
  extends PartialEnd;
  parameter Units.Force  F = 0      "Force at the end, positive towards it";
  parameter Units.Length d = 0.5e-3 "Distance over which it falls to a quarter";
equation
  f = (if side > 0 then F else -F)/(1 + x/d)^2;

  annotation(__mocc(
    effect   = "amplitude=F; side=-1,1; s_lo=min(s); s_hi=max(s); d=0.06*span(s),0.15*span(s),0.3*span(s)",
    law      = "f = F/(1 + x/d)^2 towards the end",
    explains = "%at is attracted by an end of its stroke, as by a magnet."));
end MagneticForce;
