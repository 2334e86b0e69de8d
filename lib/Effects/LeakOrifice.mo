within Effects;
model LeakOrifice "Leak through a hole"
  //   m_flow = iso6358(p_a, p_b, C, b)
  // See Pneumatics.iso6358.
  extends PartialLeak;
  parameter Units.SonicConductance C = 0   "Sonic conductance";
  parameter Units.Fraction         b = 0.3 "Critical pressure ratio";
equation
  m_flow = Pneumatics.iso6358(p_a, p_b, C, b);

  annotation(__mocc(
    effect   = "amplitude=C>0; b=0.15,0.45",
    law      = "m_flow = iso6358(p_a, p_b, C, b)",
    explains = "%at leaks as through a hole."));
end LeakOrifice;
