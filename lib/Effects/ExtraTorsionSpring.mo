within Effects;
model ExtraTorsionSpring "Torsion spring with preload to the housing"
  //   tau = -(M_0 + c (phi - phi_0))
  // An inertia J on this spring alone oscillates with sqrt(c/J).
  extends PartialTorque;
  parameter Units.RotationalStiffness c     = 0 "Stiffness";
  parameter Units.Torque              M_0   = 0 "Preload at phi_0, positive if it turns towards -phi";
  parameter Units.Angle               phi_0 = 0 "Angle at which the spring turns with the preload";
equation
  tau = -(M_0 + c*(phi - phi_0));

  annotation(__mocc(
    effect   = "amplitude=c>0,M_0; phi_0=min(phi)",
    law      = "tau = -(M_0 + c (phi - phi_0))",
    explains = "A torsion spring acts on %at."));
end ExtraTorsionSpring;
