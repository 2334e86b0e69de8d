within Effects;
model FreeForceOverPosition "Force as a free curve over the position"
  //   f = F(s)
  // F is a smooth curve through the n amplitudes F at n positions, equally spaced from s_lo to s_hi (knotWeights).
  // For effects of which only the dependence on the position is known: the curve shows where to look.
  extends PartialForce;
  parameter Integer        n    = 8        "Number of knots";
  parameter Units.Force    F[n] = zeros(n) "Force at each knot, positive towards +s";
  parameter Units.Position s_lo = 0        "First knot";
  parameter Units.Position s_hi = 1        "Last knot";
equation
  f = F*knotWeights((s - s_lo)/(s_hi - s_lo)*(n - 1), n);

  annotation(__mocc(
    effect   = "amplitude=F; s_lo=min(s); s_hi=max(s)",
    law      = "f = F(s)",
    formula  = "extends=PartialForce; knots=F; count=n; over=s; from=s_lo; to=s_hi; equation=f = F(s)",
    explains = "A force that depends on position alone acts on %at, by a law that is not known in advance."));
end FreeForceOverPosition;
