// A closed end: nothing flows, so the balance says nothing of what would come in. It is what is behind it.
model ClosedEnd
  connector Port
    Real p;
    flow Real m_flow;
    Real h;
    flow Real H_flow;
  end Port;
  model Boundary
    Port port;
    parameter Real h = 3;
  equation
    port.p = 1;
    port.H_flow = semiLinear(port.m_flow, port.h, h*time);
  end Boundary;
  Boundary boundary;
end ClosedEnd;
