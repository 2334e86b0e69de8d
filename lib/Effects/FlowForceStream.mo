within Effects;
model FlowForceStream "Momentum of the stream through a seal, along the flow"
  //   f = w m_flow
  // A stream that leaves the gap at a constant speed w, as a choked jet does, carries the momentum w m_flow, and the
  // spool takes up its axial part. The force changes sign with the flow.
  // Source: Merritt (1967), "Hydraulic Control Systems", section 5.6, with a constant speed.
  extends PartialSealForce;
  parameter Units.Velocity w = 0 "Axial part of the speed, positive if a flow from a to b pushes towards +s";

  input Units.MassFlowRate m_flow "Mass flow through the gap, from a to b";
equation
  f = w*m_flow;

  annotation(__mocc(
    effect   = "amplitude=w; host=spool,port_a,port_b; bind m_flow=gap.m_flow|m_flow",
    law      = "f = w m_flow",
    explains = "The air that flows past %at drags the spool along: momentum of the stream."));
end FlowForceStream;
