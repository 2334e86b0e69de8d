within Effects;
model UnknownHeatFlow "Heat flow as a free curve over time"
  //   Q_flow = P(t)
  // P is a smooth curve through the n amplitudes P at n times, equally spaced from t_lo to t_hi (knotWeights). This is
  // not an effect but a question to the recordings: which heat flow would close the balance here, and when?
  extends PartialHeat;
  parameter Integer            n    = 48       "Number of knots";
  parameter Units.HeatFlowRate P[n] = zeros(n) "Heat flow at each knot, into the body";
  parameter Units.Time         t_lo = 0        "First knot";
  parameter Units.Time         t_hi = 1        "Last knot";
equation
  Q_flow = P*knotWeights((time - t_lo)/(t_hi - t_lo)*(n - 1), n);

  annotation(__mocc(
    unknown  = "amplitude=P; inflow=Q_flow; over=T",
    explains = "Heat at %at that the model does not have."));
end UnknownHeatFlow;
