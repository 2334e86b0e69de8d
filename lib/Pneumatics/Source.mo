within Pneumatics;
model Source "Air supply with constant pressure, at its port or at the far end of a line"
  //   V/(R T) dp_port/dt = (p - p_port)/R_line - m_out,   tau_line = R_line V/(R T)
  // With has_line, a line with resistance R_line and volume V connects the supply to the port. The equation is
  // written for the pressure drop p - p_port, so that R_line = 0 is the supply without a line and needs no different
  // equations. With is_orifice, the line restricts the flow as in ISO 6358:
  //   V_line/(R T) dp_port/dt = iso6358(p, p_port, C_line, b_line) - m_out
  parameter Units.AbsolutePressure p               "Absolute pressure";
  parameter Boolean                has_line = false "True if there is a line";
  parameter Units.FlowResistance   R_line   = 0     "Line: resistance";
  parameter Units.Time             tau_line = 2e-3  "Line: time constant";

  parameter Boolean                is_orifice = false "True if the line restricts the flow by C_line, not by R_line";
  parameter Units.SonicConductance C_line   = 1e-8  "Line: sonic conductance";
  parameter Units.Fraction         b_line   = 0.3   "Line: critical pressure ratio";
  parameter Units.Volume           V_line   = 1e-5  "Line: volume behind the restriction";

  Units.PressureDifference p_lost(start = 0, fixed = has_line) "Pressure lost in the line";

  Port port;
equation
  if has_line then
    port.p = p - p_lost;
    if is_orifice then
      V_line/(Air.R*Air.T)*der(p_lost) = -port.m_flow - iso6358(p, port.p, C_line, b_line);
    else
      tau_line*der(p_lost) = -R_line*port.m_flow - p_lost;
    end if;
  else
    port.p = p;
    p_lost = 0;
  end if;

  annotation(__mocc(
    effect   = "with has_line=true; amplitude=R_line>0; tau_line=1e-3,3e-3,10e-3",
    law      = "V/(R T) dp_port/dt = (p - p_port)/R_line - m_out",
    choice   = "with has_line=true; with is_orifice=true; C_line=1e-9,1e-8,1e-7; V_line=1e-6,1e-5,1e-4",
    chosen   = "V_line/(R T) dp_port/dt = iso6358(p, p_port, C_line, b_line) - m_out",
    explains = "The pressure at %at drops while air flows, as behind a long line."));
end Source;
