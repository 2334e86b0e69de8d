within Effects;
model OneWayCushion "Damping on the way towards an end of the stroke"
  //   f = -d max(0, 1 - x/w)^n v   while v leads to the end
  // x is the distance to the end. Air that has to leave a narrowing gap comes back through a check valve, so that the
  // way out is free.
  extends PartialEnd;
  parameter Units.DampingCoefficient d = 0      "Damping coefficient at the end";
  parameter Units.Length             w = 0.5e-3 "Length over which it acts";
  parameter Units.Exponent           n = 2      "Exponent of the remaining gap";
equation
  f = -d*noEvent(if x < w and v_in > 0 then (1 - x/w)^n*v else 0);

  annotation(__mocc(
    effect   = "amplitude=d>0; side=-1,1; s_lo=min(s); s_hi=max(s); w=0.07*span(s),0.15*span(s),0.3*span(s); n=1,2",
    law      = "f = -d max(0, 1 - x/w)^n v while v leads to the end",
    explains = "%at is cushioned on its way to an end of its stroke."));
end OneWayCushion;
