within Effects;
model SealPressureFriction "Friction that grows with the pressure difference across one seal"
  //   |f| = A |p_a - p_b| while sliding, and at most that at rest
  // The pressure presses the lip onto the housing, over the whole stroke.
  parameter Units.EffectiveArea A = 0 "Friction per pressure difference";

  Units.PressureDifference dp "Pressure difference, as a magnitude";
  Units.Force              f  "The friction";

  Translational.SpoolFlange spool  "The spool";
  Pneumatics.Port           port_a "One side of the seal";
  Pneumatics.Port           port_b "Other side of the seal";
equation
  dp = noEvent(abs(port_a.p - port_b.p));
  f = A*dp;
  port_a.m_flow = 0;
  port_b.m_flow = 0;
  spool.f_slide = -f;
  spool.f_static = -f;
  spool.f_push = 0;

  annotation(__mocc(
    effect   = "amplitude=A; host=spool,port_a,port_b",
    law      = "|f| = A |p_a - p_b| while sliding, and at most that at rest",
    explains = "The friction of %at grows with the pressure difference in a different way than in the model."));
end SealPressureFriction;
