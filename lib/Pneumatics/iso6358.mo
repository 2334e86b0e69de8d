within Pneumatics;
function iso6358 "Mass flow through a restriction according to ISO 6358, from a to b, in either direction"
  //   m_flow = C rho_0 p_1 psi(p_2/p_1),   p_1 upstream, p_2 downstream
  //   psi(r) = 1                               choked, for r <= b
  //   psi(r) = sqrt(1 - ((r - b)/(1 - b))^2)   subsonic
  // Between r_linear and 1, where the root would have a vertical tangent, psi falls linearly to 0. The pieces join
  // continuously; as in every function, passing from one to the next is not an event.
  // Source: ISO 6358.
  input  Units.AbsolutePressure p_a    "Pressure at a";
  input  Units.AbsolutePressure p_b    "Pressure at b";
  input  Units.SonicConductance C      "Sonic conductance";
  input  Units.Fraction         b      "Critical pressure ratio, below 1";
  output Units.MassFlowRate     m_flow "Mass flow, positive from a to b";
protected
  constant Units.Fraction r_linear = 0.999;
  Boolean forward "True if a is upstream";
  Units.AbsolutePressure p_1 "Upstream pressure";
  Units.AbsolutePressure p_2 "Downstream pressure";
  Units.Fraction r   "Pressure ratio";
  Units.Fraction z   "Place between choking (0) and standstill (1)";
  Units.Fraction psi "Flow function, 0 to 1";
algorithm
  forward := p_a >= p_b;
  p_1 := if forward then p_a else p_b;
  p_2 := if forward then p_b else p_a;
  r := p_2/p_1;
  z := max(0, (min(r, r_linear) - b)/(1 - b));
  psi := sqrt(1 - z^2)*(if r <= r_linear then 1 else (1 - r)/(1 - r_linear));
  m_flow := (if forward then 1 else -1)*C*Air.rho_0*p_1*psi;
end iso6358;
