within Effects;
model UnknownForce "Force as a free curve over time"
  //   f = F(t)
  // F is a smooth curve through the n amplitudes F at n times, equally spaced from t_lo to t_hi (knotWeights). This
  // is not an effect but a question to the recordings: which force would close the balance here, and when?
  extends PartialForce;
  parameter Integer     n    = 48       "Number of knots";
  parameter Units.Force F[n] = zeros(n) "Force at each knot, positive towards +s";
  parameter Units.Time  t_lo = 0        "First knot";
  parameter Units.Time  t_hi = 1        "Last knot";

  Units.Velocity v "Speed";
equation
  v = der(s);
  f = F*knotWeights((time - t_lo)/(t_hi - t_lo)*(n - 1), n);

  annotation(__mocc(
    unknown  = "amplitude=F; inflow=f; over=s,v",
    explains = "A force on %at that the model does not have."));
end UnknownForce;
