within Effects;
model FreeTorqueOverAngle "Torque as a free curve over the angle"
  //   tau = M(phi)
  // M is a smooth curve through the n amplitudes M at n angles, equally spaced from phi_lo to phi_hi (knotWeights). For
  // effects of which only the dependence on the angle is known: the curve shows where to look.
  extends PartialTorque;
  parameter Integer      n      = 8        "Number of knots";
  parameter Units.Torque M[n]   = zeros(n) "Torque at each knot, positive towards +phi";
  parameter Units.Angle  phi_lo = 0        "First knot";
  parameter Units.Angle  phi_hi = 1        "Last knot";
equation
  tau = M*knotWeights((phi - phi_lo)/max(phi_hi - phi_lo, 1e-9)*(n - 1), n);

  annotation(__mocc(
    effect   = "amplitude=M; phi_lo=min(phi); phi_hi=max(phi)",
    law      = "tau = M(phi)",
    formula  = "extends=PartialTorque; knots=M; count=n; over=phi; from=phi_lo; to=phi_hi; equation=tau = F(phi)",
    explains = "A torque that depends on the angle alone acts on %at, by a law that is not known in advance."));
end FreeTorqueOverAngle;
