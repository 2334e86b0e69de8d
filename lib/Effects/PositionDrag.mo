within Effects;
model PositionDrag "Damping that grows with the position"
  //   f = -d x v,   x = (s - s_lo)/(s_hi - s_lo) for side > 0, else (s_hi - s)/(s_hi - s_lo)
  // A gap filled with grease whose length grows with the stroke, or a damper with a groove of varying depth.
  extends PartialDrag;
  parameter Units.DampingCoefficient d = 0 "Damping coefficient at the end where it is greatest";
  parameter Integer        side = 1 "+1: greatest at the upper end, -1: at the lower end";
  parameter Units.Position s_lo = 0 "Lower end";
  parameter Units.Position s_hi = 1 "Upper end";
equation
  f = -d*(if side > 0 then s - s_lo else s_hi - s)/(s_hi - s_lo)*v;

  annotation(__mocc(
    effect   = "amplitude=d>0; side=-1,1; s_lo=min(s); s_hi=max(s)",
    law      = "f = -d (s - s_lo)/(s_hi - s_lo) v",
    explains = "%at is damped in proportion to its speed, the more the further it is towards an end."));
end PositionDrag;
