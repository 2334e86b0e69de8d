within Effects;
model ExtraSpring "Spring with preload to the housing"
  //   f = -(F_0 + c (s - s_0))
  // A mass m on this spring alone oscillates with sqrt(c/m).
  extends PartialForce;
  parameter Units.SpringStiffness c   = 0 "Stiffness";
  parameter Units.Force           F_0 = 0 "Preload at s_0, positive if it pulls towards -s";
  parameter Units.Position        s_0 = 0 "Position at which the spring pulls with the preload";
equation
  f = -(F_0 + c*(s - s_0));

  annotation(__mocc(
    effect   = "amplitude=c>0,F_0; s_0=min(s)",
    law      = "f = -(F_0 + c (s - s_0))",
    explains = "A spring acts on %at."));
end ExtraSpring;
