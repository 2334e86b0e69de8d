within Effects;
model LeakPorous "Leak through a porous wall or a long gap, viscous and inertial"
  //   p_a^2 - p_b^2 = m_flow/G (1 + |m_flow|/m_t),   m_t = G p_t^2
  // Viscous friction at small flows and inertia at large ones: Forchheimer's law for an isothermal gas; LeakLaminar is
  // its limit for p_t -> infinity. At p_a^2 - p_b^2 = 2 p_t^2 both parts are equal. Solved for m_flow without the
  // cancellation that the usual formula of the root has at small flows.
  // Source: Bear (1972), "Dynamics of Fluids in Porous Media", section 5.11.
  extends PartialLeak;
  parameter Units.LaminarConductance G   = 0   "Mass flow per difference of the squares of the pressures, at small flows";
  parameter Units.AbsolutePressure   p_t = 5e5 "Pressure at which inertia begins to count";

  Real x "Difference of the squares of the pressures over p_t^2";
equation
  x = (p_a^2 - p_b^2)/p_t^2;
  m_flow = 2*G*p_t^2*x/(1 + sqrt(1 + 4*abs(x)));

  annotation(__mocc(
    effect   = "amplitude=G>0; p_t=0.3*max(p_a),3*max(p_a)",
    law      = "m_flow = 2 G (p_a^2 - p_b^2)/(1 + sqrt(1 + 4 |p_a^2 - p_b^2|/p_t^2))",
    explains = "%at leaks through a porous wall, and inertia counts at large flows."));
end LeakPorous;
