within Effects;
model BearingFriction "Dry friction of a bearing"
  //   tau = -M z,   |tau| = M while turning,   |tau| <= M at rest
  // Coulomb's law, with an elastic beginning over a small angle (PartialDryFriction), which holds a stuck shaft.
  extends PartialDryFriction;
  parameter Units.Torque M = 0 "Friction torque while turning";
equation
  tau = -M*z;

  annotation(__mocc(
    effect   = "amplitude=M>0; delta=1e-5*span(phi)",
    law      = "tau = -M z",
    explains = "Dry friction brakes %at, and holds it at rest."));
end BearingFriction;
