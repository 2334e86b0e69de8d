within Effects;
model TwistSpring "Torsion spring between two shafts, in addition to existing ones"
  //   tau = M_0 + c phi_rel
  // Two inertias J with this spring alone oscillate against each other with sqrt(2 c/J).
  extends PartialTwist;
  parameter Units.RotationalStiffness c   = 0 "Stiffness";
  parameter Units.Torque              M_0 = 0 "Preload: torque without a twist";
equation
  tau = M_0 + c*phi_rel;

  annotation(__mocc(
    effect   = "amplitude=c>0,M_0",
    law      = "tau = M_0 + c phi_rel",
    explains = "A torsion spring acts across %at."));
end TwistSpring;
