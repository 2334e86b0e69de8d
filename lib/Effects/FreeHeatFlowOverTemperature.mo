within Effects;
model FreeHeatFlowOverTemperature "Heat flow as a free curve over the temperature"
  //   Q_flow = P(T)
  // P is a smooth curve through the n amplitudes P at n temperatures, equally spaced from T_lo to T_hi (knotWeights). For
  // effects of which only the dependence on the temperature is known.
  extends PartialHeat;
  parameter Integer            n    = 8        "Number of knots";
  parameter Units.HeatFlowRate P[n] = zeros(n) "Heat flow at each knot, into the body";
  parameter Units.Temperature  T_lo = 273.15   "First knot";
  parameter Units.Temperature  T_hi = 373.15   "Last knot";
equation
  Q_flow = P*knotWeights((T - T_lo)/max(T_hi - T_lo, 1e-6)*(n - 1), n);

  annotation(__mocc(
    effect   = "amplitude=P; T_lo=min(T); T_hi=max(T)",
    law      = "Q_flow = P(T)",
    formula  = "extends=PartialHeat; knots=P; count=n; over=T; from=T_lo; to=T_hi; equation=Q_flow = F(T)",
    explains = "%at receives heat that depends on its temperature alone, by a law that is not known in advance."));
end FreeHeatFlowOverTemperature;
