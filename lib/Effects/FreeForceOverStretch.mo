within Effects;
model FreeForceOverStretch "Force between two bodies as a free curve over their distance"
  //   f = F(s_rel)
  // F is a smooth curve through the n amplitudes F at n distances, equally spaced from s_lo to s_hi (knotWeights). For
  // effects of which only the dependence on the distance is known.
  extends PartialStretch;
  parameter Integer      n    = 8        "Number of knots";
  parameter Units.Force  F[n] = zeros(n) "Force at each knot";
  parameter Units.Length s_lo = 0        "First knot";
  parameter Units.Length s_hi = 1        "Last knot";
equation
  f = F*knotWeights((s_rel - s_lo)/(s_hi - s_lo)*(n - 1), n);

  annotation(__mocc(
    effect   = "between=moving; series=true; amplitude=F; s_lo=min(s_rel); s_hi=max(s_rel)",
    law      = "f = F(s_rel)",
    formula  = "extends=PartialStretch; knots=F; count=n; over=s_rel; from=s_lo; to=s_hi; equation=f = F(s_rel)",
    explains = "A force that depends on the deflection alone acts across %at, by a law that is not known in advance."));
end FreeForceOverStretch;
