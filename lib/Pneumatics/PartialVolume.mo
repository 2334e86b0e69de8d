within Pneumatics;
partial model PartialVolume "Isothermal air in a volume; the derived class gives its size"
  // The mass of air is the state, not the pressure: air that leaves one volume enters the next to the last digit, and
  // a moving piston changes the pressure without a term in dV/dt.
  parameter Units.AbsolutePressure p_start = Air.p_ambient "Pressure at the start";
  parameter Units.Volume           V_nominal = 1e-6        "Size, to scale the mass for the solver";

  Units.AbsolutePressure p(start = p_start)   "Absolute pressure";
  Units.Volume           V(start = V_nominal) "Volume";
  Units.Mass             m(start = p_start*V_nominal/(Air.R*Air.T), nominal = Air.p_ambient*V_nominal/(Air.R*Air.T),
                           stateSelect = StateSelect.prefer) "Mass of air";

  Port port;
initial equation
  p = p_start;
equation
  der(m) = port.m_flow;
  m = p*V/(Air.R*Air.T);
  port.p = p;
end PartialVolume;
