within Effects;
model FreeBypass "Flow past a component as a free curve over the difference of the potentials"
  //   f = F(de)
  // F is a smooth curve through the n amplitudes F at n differences, equally spaced from de_lo to de_hi (knotWeights).
  // For flows of which only the dependence on the difference is known.
  extends PartialBypass;
  parameter Integer n     = 7        "Number of knots";
  parameter Real    F[n]  = zeros(n) "Flow at each knot, in the unit of the connector";
  parameter Real    de_lo = 0        "First knot";
  parameter Real    de_hi = 1        "Last knot";
equation
  f = F*knotWeights((de - de_lo)/max(de_hi - de_lo, 1e-12)*(n - 1), n);

  annotation(__mocc(
    effect   = "amplitude=F; de_lo=min(de); de_hi=max(de)",
    law      = "f = F(de)",
    formula  = "extends=PartialBypass; knots=F; count=n; over=de; from=de_lo; to=de_hi; equation=f = F(de)",
    explains = "A flow passes %at that depends on the difference of the potentials by a law that is not known in advance."));
end FreeBypass;
