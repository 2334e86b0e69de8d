within Effects;
model LineLag "Flow through a line of which a part follows its pressures late"
  //   m_flow = -T (m_host - y)/tau,   tau dy/dt = m_host - y
  // m_host is the flow of the component alone. With T = tau this is LineInertia, whose score at tau = 0 misses lags that
  // are long compared with the changes of the flow; this one is scored with lags of several lengths.
  extends PartialLeak;
  input Units.MassFlowRate m_host "Flow of the component alone, from a to b";
  parameter Units.Time T   = 0    "How late a slow change of the flow is";
  parameter Units.Time tau = 1e-3 "Time constant";

  Units.Time         t = time "Time";
  Units.MassFlowRate y        "m_host, with a lag";
initial equation
  y = m_host;
equation
  tau*der(y) = m_host - y;
  m_flow = -T*(m_host - y)/tau;

  annotation(__mocc(
    effect   = "series=true; amplitude=T>0; tau=0.0025*span(t),0.008*span(t),0.025*span(t),0.08*span(t); host=port_a,port_b; bind m_host=m_flow; named=Effects.LineInertia",
    law      = "m_flow = -T (m_host - y)/tau, tau dy/dt = m_host - y",
    explains = "The flow through %at follows late: the air in the line has to be accelerated."));
end LineLag;
