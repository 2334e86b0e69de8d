within Effects;
model FreeTorqueOverSpeed "Friction torque as a free curve over the speed"
  //   tau = -M(|w|) z
  // M is a smooth curve through the n amplitudes M at n speeds, equally spaced from 0 to w_hi (knotWeights), and z the
  // direction (PartialDryFriction). For effects of which only the dependence on the speed is known.
  extends PartialDryFriction;
  parameter Integer               n    = 8        "Number of knots";
  parameter Units.Torque          M[n] = zeros(n) "Friction torque at each knot";
  parameter Units.AngularVelocity w_hi = 1        "Last knot";
equation
  tau = -z*(M*knotWeights(speed/max(w_hi, 1e-9)*(n - 1), n));

  annotation(__mocc(
    effect   = "amplitude=M; delta=1e-5*span(phi); w_hi=max(speed)",
    law      = "tau = -M(|w|) z",
    formula  = "extends=PartialDryFriction; knots=M; count=n; over=speed; to=w_hi; equation=tau = -z*F(speed)",
    explains = "A torque that depends on the speed alone brakes %at, by a law that is not known in advance."));
end FreeTorqueOverSpeed;
