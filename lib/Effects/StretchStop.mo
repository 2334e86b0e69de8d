within Effects;
model StretchStop "Elastic stop between two bodies beyond a distance"
  //   f = side c w (x/w)^n,   x = max(0, side (s_rel - l_0))
  // A rubber buffer in a strut. Potential: c w^2/(n + 1) (x/w)^(n + 1). With n = 1 it is a spring with the stiffness c that is
  // not fastened.
  extends PartialStretch;
  parameter Units.SpringStiffness c    = 0    "Stiffness at the depth w, by n";
  parameter Units.Length          l_0  = 0    "Distance at which the stop begins";
  parameter Units.Exponent        n    = 1    "Exponent of the depth";
  parameter Units.Length          w    = 1e-3 "Depth to which c refers";
  parameter Integer               side = 1    "+1 beyond l_0, -1 below l_0";

  Units.Length x "Depth";
equation
  x = noEvent(max(0, side*(s_rel - l_0)));
  f = side*c*w*regularPower(x/w, n);

  annotation(__mocc(
    effect   = "between=moving; series=true; amplitude=c>0; l_0=s_rel(9); n=1,2; w=0.1*span(s_rel); side=-1,1",
    law      = "f = side c w (x/w)^n,  x = max(0, side (s_rel - l_0))",
    explains = "%at meets an elastic stop."));
end StretchStop;
