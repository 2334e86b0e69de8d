within Effects;
model AddedInertia "Additional moment of inertia that turns along"
  //   tau = -J dw/dt
  // A coupling or a load heavier than specified, or liquid that is carried along.
  extends PartialBearing;
  parameter Units.MomentOfInertia J = 0 "Additional moment of inertia";

  Units.AngularAcceleration a "Acceleration";
equation
  a = der(w);
  tau = -J*a;

  annotation(__mocc(
    effect   = "amplitude=J>0",
    law      = "tau = -J dw/dt",
    explains = "%at turns an additional inertia."));
end AddedInertia;
