within Effects;
model FreeTorqueOverTwist "Torque between two shafts as a free curve over the twist"
  //   tau = M(phi_rel)
  // M is a smooth curve through the n amplitudes M at n angles, equally spaced from phi_lo to phi_hi (knotWeights). For
  // couplings of which only the dependence on the twist is known.
  extends PartialTwist;
  parameter Integer      n      = 8        "Number of knots";
  parameter Units.Torque M[n]   = zeros(n) "Torque at each knot";
  parameter Units.Angle  phi_lo = 0        "First knot";
  parameter Units.Angle  phi_hi = 1        "Last knot";
equation
  tau = M*knotWeights((phi_rel - phi_lo)/(phi_hi - phi_lo)*(n - 1), n);

  annotation(__mocc(
    effect   = "between=moving; series=true; amplitude=M; phi_lo=min(phi_rel); phi_hi=max(phi_rel)",
    law      = "tau = M(phi_rel)",
    formula  = "extends=PartialTwist; knots=M; count=n; over=phi_rel; from=phi_lo; to=phi_hi; equation=tau = F(phi_rel)",
    explains = "A torque that depends on the twist alone acts across %at, by a law that is not known in advance."));
end FreeTorqueOverTwist;
