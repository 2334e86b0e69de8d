within Effects;
partial model PartialStorage "Air stored at a port, in addition to existing volumes"
  Units.AbsolutePressure p      "Pressure";
  Units.MassFlowRate     m_flow "Mass flow taken up";

  Pneumatics.Port port;
equation
  p = port.p;
  port.m_flow = m_flow;
end PartialStorage;
