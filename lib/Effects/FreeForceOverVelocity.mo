within Effects;
model FreeForceOverVelocity "Friction as a free curve over the speed"
  //   |f| = F(|v|) while sliding,   |f| <= F(0) at rest
  // F is a smooth curve through the n amplitudes F at n speeds, equally spaced from 0 to v_hi (knotWeights). For
  // effects of which only the dependence on the speed is known.
  extends PartialFriction;
  parameter Integer        n    = 8        "Number of knots";
  parameter Units.Force    F[n] = zeros(n) "Friction at each knot";
  parameter Units.Velocity v_hi = 1        "Last knot";
equation
  f_slide = F*knotWeights(speed/v_hi*(n - 1), n);
  f_static = F[1];

  annotation(__mocc(
    effect   = "amplitude=F; v_hi=max(speed)",
    law      = "|f| = F(|v|) while sliding",
    formula  = "extends=PartialFriction; knots=F; count=n; over=speed; to=v_hi; equation=f_slide = F(speed); equation=f_static = F(0)",
    explains = "Friction that depends on speed alone acts on %at, by a law that is not known in advance."));
end FreeForceOverVelocity;
