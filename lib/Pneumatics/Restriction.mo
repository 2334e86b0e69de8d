within Pneumatics;
model Restriction "Fixed restriction: a line, a port, a silencer"
  //   m_flow = iso6358(p_a, p_b, C, b)
  // See iso6358.
  extends PartialRestriction;
equation
  opening = 1;

  annotation(__mocc(
    effect   = "amplitude=blocked",
    law      = "m_flow = iso6358(p_a, p_b, C, b)",
    explains = "The conductance of %at differs from the data sheet: dirt, or another restriction in series."));
end Restriction;
