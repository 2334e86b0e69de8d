within Effects;
partial model PartialStorage "Air that a port takes up and gives back beside what is there"
  Units.AbsolutePressure p      "Pressure";
  Units.MassFlowRate     m_flow "Mass flow taken up";

  Pneumatics.Port port;
equation
  p = port.p;
  port.m_flow = m_flow;
end PartialStorage;
