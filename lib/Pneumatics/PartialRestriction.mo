within Pneumatics;
partial model PartialRestriction "Restriction between two ports; the derived class gives its opening"
  parameter Units.SonicConductance C       "Sonic conductance, fully open";
  parameter Units.Fraction         b = 0.3 "Critical pressure ratio";
  parameter Units.Fraction         blocked = 0 "Share of the conductance that is lost; negative: wider than C";

  Units.Fraction     opening "Share of the conductance that is open";
  Units.MassFlowRate m_flow  "Mass flow from a to b";

  Port port_a;
  Port port_b;
equation
  m_flow = iso6358(port_a.p, port_b.p, C*(1 - blocked)*opening, b);
  port_a.m_flow = m_flow;
  port_b.m_flow = -m_flow;
  assert(b >= 0 and b < 1, "Restriction: the critical pressure ratio b must lie in [0, 1)");
end PartialRestriction;
