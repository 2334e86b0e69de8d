within Effects;
model UnknownCurrent "Current into the circuit as a free curve over time"
  //   i = I(t)
  // I is a smooth curve through the m amplitudes I at m times, equally spaced from t_lo to t_hi (knotWeights). This is
  // not an effect but a question to the recordings: which current would close the balance here, and when?
  extends PartialInjection;
  parameter Integer       m    = 48       "Number of knots";
  parameter Units.Current I[m] = zeros(m) "Current at each knot, into the circuit";
  parameter Units.Time    t_lo = 0        "First knot";
  parameter Units.Time    t_hi = 1        "Last knot";
equation
  i = I*knotWeights((time - t_lo)/(t_hi - t_lo)*(m - 1), m);

  annotation(__mocc(
    unknown  = "amplitude=I; inflow=i; over=v",
    explains = "A current at %at that the model does not have."));
end UnknownCurrent;
