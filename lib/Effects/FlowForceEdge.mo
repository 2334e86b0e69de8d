within Effects;
model FlowForceEdge "Momentum of the jet at a seal while its edge meters"
  //   f = k |m_flow| v exp(-((s - s_ce)/w)^2)
  // The air leaves the gap as a jet with speed v (Pneumatics.jetSpeed), and the spool takes up the axial part of its
  // momentum, in either direction of the flow. The axial part is large only near the control edge s_ce: far past the
  // edge the jet leaves at a right angle to the spool. The bell is that of the push-in force of the spool valve
  // paper.
  // Source: Merritt (1967), "Hydraulic Control Systems", section 5.6, with the isentropic speed of air.
  extends PartialSealForce;
  parameter Units.Fraction k = 0      "Axial part of the momentum at the edge, positive towards +s";
  parameter Units.Length   w = 0.2e-3 "Width: distance from the edge at which 37 % of it acts";

  input Units.MassFlowRate m_flow "Mass flow through the gap";
  input Units.Position     s_ce   "Stroke at which the seal meets its control edge";
  Units.Velocity           v      "Speed of the jet";
equation
  v = Pneumatics.jetSpeed(p_a, p_b);
  f = k*noEvent(abs(m_flow))*v*exp(-((spool.s - s_ce)/w)^2);

  annotation(__mocc(
    effect   = "amplitude=k; host=spool,port_a,port_b; bind m_flow=gap.m_flow|m_flow; bind s_ce=s_ce; w=0.03*span(spool.s),0.06*span(spool.s),0.12*span(spool.s)",
    law      = "f = k |m_flow| v exp(-((s - s_ce)/w)^2)",
    explains = "The air that flows past %at pushes the spool where the edge meters: momentum of the jet."));
end FlowForceEdge;
