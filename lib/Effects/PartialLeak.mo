within Effects;
partial model PartialLeak "Flow between two ports, in addition to existing ones"
  Units.AbsolutePressure   p_a    "Pressure at a";
  Units.AbsolutePressure   p_b    "Pressure at b";
  Units.PressureDifference dp     "p_a - p_b";
  Units.MassFlowRate       m_flow "Mass flow from a to b";

  Pneumatics.Port port_a;
  Pneumatics.Port port_b;
equation
  p_a = port_a.p;
  p_b = port_b.p;
  dp = p_a - p_b;
  port_a.m_flow = m_flow;
  port_b.m_flow = -m_flow;
end PartialLeak;
