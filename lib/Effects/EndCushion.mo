within Effects;
model EndCushion "Damping that grows towards an end of the stroke"
  //   f = -d max(0, 1 - x/w)^n v
  // x is the distance to the end. Air or grease has to leave a narrowing gap. The damping acts in both directions.
  extends PartialEnd;
  parameter Units.DampingCoefficient d = 0      "Damping coefficient at the end";
  parameter Units.Length             w = 0.5e-3 "Length over which it acts";
  parameter Units.Exponent           n = 2      "Exponent of the remaining gap";
equation
  f = -d*noEvent(if x < w then (1 - x/w)^n else 0)*v;

  annotation(__mocc(
    effect   = "amplitude=d>0; side=-1,1; s_lo=min(s); s_hi=max(s); w=0.07*span(s),0.15*span(s),0.3*span(s); n=1,2",
    law      = "f = -d max(0, 1 - x/w)^n v",
    explains = "%at is cushioned at an end of its stroke."));
end EndCushion;
