within Pneumatics;
model Source "Air supply with constant pressure, at its port or at the far end of a line"
  //   V/(R T) dp_port/dt = (p - p_port)/R_line - m_out,   tau_line = R_line V/(R T)
  // With has_line, a line with resistance R_line and volume V connects the supply to the port. The equation is
  // written for the pressure drop p - p_port, so that R_line = 0 is the supply without a line and needs no different
  // equations.
  parameter Units.AbsolutePressure p               "Absolute pressure";
  parameter Boolean                has_line = false "True if there is a line";
  parameter Units.FlowResistance   R_line   = 0     "Line: resistance";
  parameter Units.Time             tau_line = 2e-3  "Line: time constant";

  Units.PressureDifference p_lost(start = 0, fixed = has_line) "Pressure lost in the line";

  Port port;
equation
  if has_line then
    port.p = p - p_lost;
    tau_line*der(p_lost) = -R_line*port.m_flow - p_lost;
  else
    port.p = p;
    p_lost = 0;
  end if;

  annotation(__mocc(
    effect   = "with has_line=true; amplitude=R_line>0; tau_line=1e-3,3e-3,10e-3",
    explains = "The pressure at %at drops while air flows, as behind a long line."));
end Source;
