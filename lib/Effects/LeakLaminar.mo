within Effects;
model LeakLaminar "Laminar leak through a narrow gap"
  //   m_flow = G (p_a^2 - p_b^2),   G = b h^3/(24 eta L R T)
  // Isothermal gas between parallel walls of width b, height h and length L, with viscosity eta (Poiseuille's law
  // with the density at the local pressure). From a volume V into a space at p_0: dp/dt = -G R T/V (p^2 - p_0^2).
  extends PartialLeak;
  parameter Units.LaminarConductance G = 0 "Mass flow per difference of the squares of the pressures";
equation
  m_flow = G*(p_a^2 - p_b^2);

  annotation(__mocc(
    effect   = "amplitude=G>0",
    law      = "m_flow = G (p_a^2 - p_b^2)",
    explains = "%at leaks through a narrow gap."));
end LeakLaminar;
