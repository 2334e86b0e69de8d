within Effects;
model UnknownPortFlow "Flow into a connection set as a free curve over time"
  // F is a smooth curve through the n amplitudes F at n times, equally spaced from t_lo to t_hi (knotWeights). This is
  // not an effect but a question to the recordings: which flow would close the balance here, and when?
  parameter Integer    n    = 48       "Number of knots";
  parameter Real       F[n] = zeros(n) "Flow at each knot, positive into what is connected";
  parameter Units.Time t_lo = 0        "First knot";
  parameter Units.Time t_hi = 1        "Last knot";

  Real e "Potential";
  Real f "Flow into what is connected";

  AnyPort port;
equation
  e = port.e;
  f = F*knotWeights((time - t_lo)/(t_hi - t_lo)*(n - 1), n);
  port.f = -f;

  annotation(__mocc(
    unknown  = "amplitude=F; inflow=f; over=e",
    explains = "A flow at %at that the model does not have."));
end UnknownPortFlow;
