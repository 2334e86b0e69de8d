within Effects;
model FreeForceOverStretchRate "Force between two bodies as a free curve over the difference of their speeds"
  //   f = F(v_rel)
  // F is a smooth curve through the n amplitudes F at n speeds, equally spaced from v_lo to v_hi (knotWeights). For dampers
  // of which only the dependence on the speed is known.
  extends PartialStretchRate;
  parameter Integer        n    = 8        "Number of knots";
  parameter Units.Force    F[n] = zeros(n) "Force at each knot";
  parameter Units.Velocity v_lo = -1       "First knot";
  parameter Units.Velocity v_hi = 1        "Last knot";
equation
  f = F*knotWeights((v_rel - v_lo)/(v_hi - v_lo)*(n - 1), n);

  annotation(__mocc(
    effect   = "between=moving; series=true; amplitude=F; v_lo=min(v_rel); v_hi=max(v_rel)",
    law      = "f = F(v_rel)",
    formula  = "extends=PartialStretchRate; knots=F; count=n; over=v_rel; from=v_lo; to=v_hi; equation=f = F(v_rel)",
    explains = "A force that depends on the speed of the deflection alone acts across %at, by a law that is not known in advance."));
end FreeForceOverStretchRate;
