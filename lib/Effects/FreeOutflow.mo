within Effects;
model FreeOutflow "Flow to the outside as a free curve over the potential"
  //   f = F(e)
  // F is a smooth curve through the n amplitudes F at n potentials, equally spaced from e_lo to e_hi (knotWeights). For
  // flows of which only the dependence on the potential is known.
  extends PartialOutflow;
  parameter Integer n    = 7        "Number of knots";
  parameter Real    F[n] = zeros(n) "Flow at each knot, in the unit of the connector";
  parameter Real    e_lo = 0        "First knot";
  parameter Real    e_hi = 1        "Last knot";
equation
  f = F*knotWeights((e - e_lo)/max(e_hi - e_lo, 1e-12)*(n - 1), n);

  annotation(__mocc(
    effect   = "amplitude=F; e_lo=min(e); e_hi=max(e)",
    law      = "f = F(e)",
    formula  = "extends=PartialOutflow; knots=F; count=n; over=e; from=e_lo; to=e_hi; equation=f = F(e)",
    explains = "A flow leaves the model at %at that depends on the potential by a law that is not known in advance."));
end FreeOutflow;
