within Effects;
model LineInertia "Flow through a line that follows its pressures late"
  //   m_flow = y - m_host,   tau dy/dt = m_host - y
  // m_host is the flow of the component alone; with this one, y flows through both. The air in a long line has to be
  // accelerated: to first order tau is its mass per area, over the slope of the pressure loss over the flow. With
  // T = sqrt(tau^2 + tau_min^2), where tau_min is short compared with everything, the equations are regular at tau = 0.
  extends PartialLeak;
  input Units.MassFlowRate m_host "Flow of the component alone, from a to b";
  parameter Units.Time tau     = 0    "Time constant";
  parameter Units.Time tau_min = 1e-6 "Time that is short compared with all changes";

  Units.Time         t = time                    "Time";
  Units.Time         T = sqrt(tau^2 + tau_min^2) "Time constant of y";
  Units.MassFlowRate y                           "m_host, with a lag";
initial equation
  y = m_host;
equation
  T*der(y) = m_host - y;
  m_flow = -tau*(m_host - y)/T;

  annotation(__mocc(
    effect   = "series=true; amplitude=tau>0; tau_min=1e-5*span(t); host=port_a,port_b; bind m_host=m_flow",
    law      = "m_flow = y - m_host, tau dy/dt = m_host - y",
    explains = "The flow through %at follows late: the air in the line has to be accelerated."));
end LineInertia;
