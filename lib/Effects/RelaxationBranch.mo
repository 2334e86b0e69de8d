within Effects;
model RelaxationBranch "Resistor and capacitor in series past a component"
  //   i = C (v - v_C)/tau,   tau dv_C/dt = v - v_C
  // A second, slower store: diffusion in a battery, dielectric absorption, or the capacitance of a cable. The resistance
  // is tau/C. It is charged to the voltage at the start.
  extends PartialBranch;
  parameter Units.Capacitance C   = 0 "Capacitance";
  parameter Units.Time        tau = 1 "Time constant";

  Units.Time    t = time "Time";
  Units.Voltage v_C      "Voltage of the capacitance";
initial equation
  v_C = v;
equation
  tau*der(v_C) = v - v_C;
  i = C*(v - v_C)/tau;

  annotation(__mocc(
    effect   = "amplitude=C>0; tau=0.01*span(t),0.05*span(t),0.3*span(t)",
    law      = "i = C (v - v_C)/tau",
    explains = "A second capacitance behind a resistor is charged along with %at."));
end RelaxationBranch;
