within Effects;
model FlowForcePressure "Pressure in the open gap of a seal"
  //   f = A x (p_a - p_b)
  // x is the open fraction of the gap. Where air flows, the pressure on the face of the spool differs from that of
  // the chamber. The incompressible flow force 2 C_d A_gap cos(angle) dp has this form.
  // Source: Merritt (1967), "Hydraulic Control Systems", section 5.6.
  extends PartialSealForce;
  parameter Units.EffectiveArea A = 0 "Effective area, fully open, positive if p_a pushes towards +s";

  input Units.Fraction opening "Share of the gap that is open";
equation
  f = A*opening*dp;

  annotation(__mocc(
    effect   = "amplitude=A; host=spool,port_a,port_b; bind opening=gap.opening|opening",
    law      = "f = A x (p_a - p_b)",
    explains = "The air that flows past %at pushes the spool: pressure in the gap."));
end FlowForcePressure;
