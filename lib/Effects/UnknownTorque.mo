within Effects;
model UnknownTorque "Torque as a free curve over time"
  //   tau = M(t)
  // M is a smooth curve through the n amplitudes M at n times, equally spaced from t_lo to t_hi (knotWeights). This is
  // not an effect but a question to the recordings: which torque would close the balance here, and when?
  extends PartialBearing;
  parameter Integer      n    = 48       "Number of knots";
  parameter Units.Torque M[n] = zeros(n) "Torque at each knot, positive towards +phi";
  parameter Units.Time   t_lo = 0        "First knot";
  parameter Units.Time   t_hi = 1        "Last knot";
equation
  tau = M*knotWeights((time - t_lo)/(t_hi - t_lo)*(n - 1), n);

  annotation(__mocc(
    unknown  = "amplitude=M; inflow=tau; over=phi,w",
    explains = "A torque on %at that the model does not have."));
end UnknownTorque;
