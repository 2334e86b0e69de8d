within Effects;
model FlowForceJet "Momentum of the jet at a seal, at any opening"
  //   f = k |m_flow| w
  // The air leaves the gap as a jet with speed w (Pneumatics.jetSpeed), and the spool takes up the axial part of its
  // momentum, k = cos(angle of the jet), in either direction of the flow. At a metering edge the force pulls the
  // spool towards closing.
  // Source: Merritt (1967), "Hydraulic Control Systems", section 5.6, with the isentropic speed of air.
  extends PartialSealForce;
  parameter Units.Fraction k = 0 "Axial part of the momentum, positive towards +s";

  input Units.MassFlowRate m_flow "Mass flow through the gap";
  Units.Velocity           w      "Speed of the jet";
equation
  w = Pneumatics.jetSpeed(p_a, p_b);
  f = k*noEvent(abs(m_flow))*w;

  annotation(__mocc(
    effect   = "amplitude=k; host=spool,port_a,port_b; bind m_flow=gap.m_flow|m_flow",
    law      = "f = k |m_flow| w",
    explains = "The air that flows past %at pushes the spool: momentum of the jet."));
end FlowForceJet;
