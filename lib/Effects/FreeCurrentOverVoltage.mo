within Effects;
model FreeCurrentOverVoltage "Current past a component as a free curve over its voltage"
  //   i = I(v)
  // I is a smooth curve through the n amplitudes I at n voltages, equally spaced from v_lo to v_hi (knotWeights). For
  // currents of which only the dependence on the voltage is known.
  extends PartialBranch;
  parameter Integer       m    = 8        "Number of knots";
  parameter Units.Current I[m] = zeros(m) "Current at each knot, from p to n";
  parameter Units.Voltage v_lo = 0        "First knot";
  parameter Units.Voltage v_hi = 1        "Last knot";
equation
  i = I*knotWeights((v - v_lo)/max(v_hi - v_lo, 1e-12)*(m - 1), m);

  annotation(__mocc(
    effect   = "amplitude=I; v_lo=min(v); v_hi=max(v)",
    law      = "i = I(v)",
    formula  = "extends=PartialBranch; knots=I; count=m; over=v; from=v_lo; to=v_hi; equation=i = F(v)",
    explains = "A current flows past %at that depends on its voltage alone, by a law that is not known in advance."));
end FreeCurrentOverVoltage;
