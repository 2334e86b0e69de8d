within Seals;
model SingleSeal "Tight seal: separates two pressures and lets nothing through"
  extends PartialSeal;
equation
  port_a.m_flow = 0;
  port_b.m_flow = 0;
end SingleSeal;
