within Pneumatics;
connector Port "Pneumatic connection"
  Units.AbsolutePressure p "Absolute pressure";
  flow Units.MassFlowRate m_flow "Air flowing into the component that owns this port";
end Port;
