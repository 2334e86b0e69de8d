within Effects;
model FreeFlow "Flow between two ports as a free curve over the pressure difference"
  //   m_flow = Q(dp),   Q(-dp) = -Q(dp)
  // Q is a smooth curve through 0 and the n amplitudes Q at n pressure differences, equally spaced from dp_lo, but at
  // least dp_hi/n, to dp_hi (knotWeights). For flows of which only the dependence on the pressure difference is known.
  extends PartialLeak;
  parameter Integer                  n     = 6        "Number of knots in addition to dp = 0";
  parameter Units.MassFlowRate       Q[n]  = zeros(n) "Mass flow at each knot";
  parameter Units.PressureDifference dp_lo = 0        "First knot, if it is greater than dp_hi/n";
  parameter Units.PressureDifference dp_hi = 1e5      "Last knot";

  Units.PressureDifference size_of_dp "Magnitude of dp";
  Real                     x          "Place among the knots: 0 at dp = 0, 1 at the first, n at the last";
protected
  parameter Units.PressureDifference first = max(if dp_lo < dp_hi then dp_lo else 0, dp_hi/n) "First knot";
equation
  size_of_dp = noEvent(abs(dp));
  x = noEvent(if size_of_dp < first then size_of_dp/first else 1 + (size_of_dp - first)/(dp_hi - first)*(n - 1));
  m_flow = (if noEvent(dp >= 0) then 1 else -1)*(cat(1, {0}, Q)*knotWeights(x, n + 1));

  annotation(__mocc(
    effect   = "amplitude=Q; dp_lo=min(size_of_dp); dp_hi=max(size_of_dp)",
    law      = "m_flow = sign(dp) Q(|dp|)",
    formula  = "extends=PartialLeak; knots=Q; count=n; over=dp; from=dp_lo; to=dp_hi; zero=true; equation=m_flow = noEvent(sign(dp))*F(noEvent(abs(dp)))",
    explains = "Air flows past %at by a law that is not known in advance."));
end FreeFlow;
