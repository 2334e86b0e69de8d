within Effects;
model UnknownFlow "Flow into a port as a free curve over time"
  //   m_flow = Q(t)
  // Q is a smooth curve through the n amplitudes Q at n times, equally spaced from t_lo to t_hi (knotWeights). This
  // is not an effect but a question to the recordings: which flow would close the balance here, and when?
  parameter Integer            n    = 48       "Number of knots";
  parameter Units.MassFlowRate Q[n] = zeros(n) "Mass flow at each knot, positive into the port";
  parameter Units.Time         t_lo = 0        "First knot";
  parameter Units.Time         t_hi = 1        "Last knot";

  Units.AbsolutePressure p      "Pressure";
  Units.MassFlowRate     m_flow "Mass flow into the port";

  Pneumatics.Port port;
equation
  p = port.p;
  m_flow = Q*knotWeights((time - t_lo)/(t_hi - t_lo)*(n - 1), n);
  port.m_flow = -m_flow;

  annotation(__mocc(
    unknown  = "amplitude=Q; inflow=m_flow; over=p",
    explains = "Air that the model does not have flows at %at."));
end UnknownFlow;
