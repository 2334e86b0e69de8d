within Effects;
model TwistDamping "Damping between two shafts, in addition to existing dampers"
  //   tau = d dphi_rel/dt
  // Losses in the material of a shaft or in a coupling. The difference of the speeds of two inertias J with this damper
  // alone decays as exp(-2 d t/J).
  extends PartialTwist;
  parameter Units.RotationalDamping d = 0 "Damping coefficient";

  Units.AngularVelocity w_rel "Difference of the speeds";
equation
  w_rel = der(phi_rel);
  tau = d*w_rel;

  annotation(__mocc(
    effect   = "amplitude=d>0",
    law      = "tau = d dphi_rel/dt",
    explains = "The twist of %at is damped."));
end TwistDamping;
