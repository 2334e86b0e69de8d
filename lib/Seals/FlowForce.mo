within Seals;
partial model FlowForce "Interface of the force of the air that flows through the gap of a seal"
  input Units.AbsolutePressure p_a     "Pressure on one side of the gap";
  input Units.AbsolutePressure p_b     "Pressure on the other side";
  input Units.MassFlowRate     m_flow  "Mass flow through the gap";
  input Units.Fraction         opening "Share of the gap that is open";
  input Boolean                opens   "True if the gap opens towards +s";

  Units.Force f "Force on the spool, positive towards +s";
end FlowForce;
