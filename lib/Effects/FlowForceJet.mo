within Effects;
model FlowForceJet "Force of the air flowing through the gap of a seal: momentum of the jet, however far it is open"
  // f = k |m_flow| w: what flows through the gap leaves it as a jet with the speed w (Pneumatics.jetSpeed), and the
  // spool takes up the axial part of its momentum, k = cos(angle of the jet), whichever way the air flows. At a
  // metering edge it pulls the spool towards closing. Merritt (1967), "Hydraulic Control Systems", section 5.6; for
  // air with the isentropic speed.
  extends PartialSealForce;
  parameter Units.Fraction k = 0 "Axial part of the momentum, positive towards +s";

  input Units.MassFlowRate m_flow "Mass flow through the gap";
  Units.Velocity           w      "Speed of the jet";
equation
  w = Pneumatics.jetSpeed(p_a, p_b);
  f = k*noEvent(abs(m_flow))*w;

  annotation(__mocc(
    effect   = "amplitude=k; host=spool,port_a,port_b; bind m_flow=gap.m_flow|m_flow",
    explains = "The air that flows past %at pushes the spool: momentum of the jet."));
end FlowForceJet;
