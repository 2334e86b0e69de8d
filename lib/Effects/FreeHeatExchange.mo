within Effects;
model FreeHeatExchange "Heat flow past a component as a free curve over the difference of the temperatures"
  //   Q_flow = Q(dT),   dT = T_a - T_b
  // Q is a smooth curve through the n amplitudes Q at n differences, equally spaced from dT_lo to dT_hi (knotWeights). For
  // heat flows of which only the dependence on the difference is known.
  extends PartialHeatExchange;
  parameter Integer                     n     = 7        "Number of knots";
  parameter Units.HeatFlowRate          Q[n]  = zeros(n) "Heat flow at each knot, from a to b";
  parameter Units.TemperatureDifference dT_lo = 0        "First knot";
  parameter Units.TemperatureDifference dT_hi = 1        "Last knot";
equation
  Q_flow = Q*knotWeights((dT - dT_lo)/max(dT_hi - dT_lo, 1e-12)*(n - 1), n);

  annotation(__mocc(
    effect   = "amplitude=Q; dT_lo=min(dT); dT_hi=max(dT)",
    law      = "Q_flow = Q(dT)",
    formula  = "extends=PartialHeatExchange; knots=Q; count=n; over=dT; from=dT_lo; to=dT_hi; equation=Q_flow = F(dT)",
    explains = "Heat passes %at that depends on the difference of the temperatures alone, by a law that is not known in advance."));
end FreeHeatExchange;
