within Seals;
model JetForce "Momentum of the jet in the gap, which pulls the spool towards closing"
  //   f = k |m_flow| w
  // The air leaves the gap at speed w (Pneumatics.jetSpeed), at an angle to the axis whose cosine is k, after
  // accelerating from rest in the chamber of the spool. In either direction of the flow the reaction closes the gap.
  // Source: Merritt (1967), "Hydraulic Control Systems", section 5.6: 69 degrees at a sharp edge with a small
  // opening, k = 0.36.
  extends FlowForce;
  parameter Units.Fraction k = 0.36 "Axial share of the momentum";

  Units.Velocity w "Speed of the jet";
equation
  w = Pneumatics.jetSpeed(p_a, p_b);
  f = (if opens then -k else k)*noEvent(abs(m_flow))*w;
end JetForce;
