within Effects;
model FlowForceStream "Force of the air flowing through the gap of a seal: along with the stream"
  // f = w m_flow: a stream that leaves the gap at a speed w of its own, whatever the pressures, as a choked jet does,
  // carries the momentum w m_flow, and the spool takes up its axial part; the force turns round with the flow.
  // Merritt (1967), "Hydraulic Control Systems", section 5.6, with a constant speed.
  extends PartialSealForce;
  parameter Units.Velocity w = 0 "Axial part of the speed, positive if a flow from a to b pushes towards +s";

  input Units.MassFlowRate m_flow "Mass flow through the gap, from a to b";
equation
  f = w*m_flow;

  annotation(__mocc(
    effect   = "amplitude=w; host=spool,port_a,port_b; bind m_flow=gap.m_flow|m_flow",
    explains = "The air that flows past %at takes the spool along: momentum of the stream."));
end FlowForceStream;
