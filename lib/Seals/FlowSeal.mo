within Seals;
model FlowSeal "Seal at a control edge: lets air through where it does not touch the housing"
  extends PartialSeal(f_air = flow_force.f);
  parameter Units.SonicConductance C       "Sonic conductance, fully open";
  parameter Units.Fraction         b = 0.3 "Critical pressure ratio";
  parameter Units.Length           w_t     "Width of the transition from closed to open";

  Pneumatics.SealOpening gap(C = C, b = b, s_ce = s_ce, w_t = w_t,
    opens = contact == Contact.CloseToOpen, s = spool.s) "The flow path";
  replaceable model FlowForce = NoFlowForce constrainedby Seals.FlowForce "Force of the air that flows through";
  FlowForce flow_force(p_a = port_a.p, p_b = port_b.p, m_flow = gap.m_flow, opening = gap.opening, opens = gap.opens);
equation
  connect(port_a, gap.port_a);
  connect(gap.port_b, port_b);
  assert(contact == Contact.CloseToOpen or contact == Contact.OpenToClose,
    "FlowSeal: a seal that opens a flow path has a control edge: CloseToOpen or OpenToClose");
end FlowSeal;
