within Effects;
partial model PartialSealForce "Force of the air on the spool at a seal"
  Units.AbsolutePressure   p_a "Pressure on one side";
  Units.AbsolutePressure   p_b "Pressure on the other side";
  Units.PressureDifference dp  "p_a - p_b";
  Units.Force              f   "The force on the spool, positive towards +s";

  Translational.SpoolFlange spool  "The spool";
  Pneumatics.Port           port_a "One side of the seal";
  Pneumatics.Port           port_b "Other side of the seal";
equation
  p_a = port_a.p;
  p_b = port_b.p;
  dp = p_a - p_b;
  port_a.m_flow = 0;
  port_b.m_flow = 0;
  spool.f_slide = 0;
  spool.f_static = 0;
  spool.f_push = -f;
end PartialSealForce;
