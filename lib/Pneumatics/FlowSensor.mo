within Pneumatics;
model FlowSensor "Measures the mass flow through it without resistance"
  Units.MassFlowRate m_flow "Mass flow from a to b";

  Port port_a;
  Port port_b;
equation
  port_a.p = port_b.p;
  port_a.m_flow = m_flow;
  port_b.m_flow = -m_flow;
end FlowSensor;
