within Effects;
model FreeForceOverVelocity "Friction over the speed as a free curve"
  // The friction runs smoothly through the n amplitudes F at n speeds, equally spaced from 0 to v_hi (knotWeights);
  // the first can also be mobilised at rest. For effects of which nothing is known but that they depend on the speed.
  extends PartialFriction;
  parameter Integer        n    = 8        "Number of knots";
  parameter Units.Force    F[n] = zeros(n) "Friction at each knot";
  parameter Units.Velocity v_hi = 1        "Last knot";
equation
  f_slide = F*knotWeights(speed/v_hi*(n - 1), n);
  f_static = F[1];

  annotation(__mocc(
    effect   = "amplitude=F; v_hi=max(speed)",
    explains = "A friction that depends on speed alone, in no form known before, acts on %at."));
end FreeForceOverVelocity;
