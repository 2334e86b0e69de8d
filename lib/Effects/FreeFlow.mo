within Effects;
model FreeFlow "Flow between two ports as a free curve over the pressure difference"
  //   m_flow = Q(dp),   Q(-dp) = -Q(dp)
  // Q is a smooth curve through 0 and the n amplitudes Q at dp_hi/n, 2 dp_hi/n, ..., dp_hi (knotWeights). For flows
  // of which only the dependence on the pressure difference is known.
  extends PartialLeak;
  parameter Integer                  n     = 6        "Number of knots in addition to dp = 0";
  parameter Units.MassFlowRate       Q[n]  = zeros(n) "Mass flow at each knot";
  parameter Units.PressureDifference dp_hi = 1e5      "Last knot";

  Units.PressureDifference size_of_dp "Magnitude of dp";
equation
  size_of_dp = noEvent(abs(dp));
  m_flow = (if noEvent(dp >= 0) then 1 else -1)*(cat(1, {0}, Q)*knotWeights(size_of_dp/dp_hi*n, n + 1));

  annotation(__mocc(
    effect   = "amplitude=Q; dp_hi=max(size_of_dp)",
    law      = "m_flow = Q(dp)",
    explains = "Air flows past %at by a law that is not known in advance."));
end FreeFlow;
