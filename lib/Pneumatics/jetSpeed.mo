within Pneumatics;
function jetSpeed "Isentropic speed of the air in the narrowest section between two pressures"
  //   w = sqrt(2 kappa/(kappa - 1) R T (1 - r^((kappa - 1)/kappa))),   r = p_2/p_1
  // It is limited by the value at the critical ratio r* = (2/(kappa + 1))^(kappa/(kappa - 1)), sqrt(2 kappa/(kappa +
  // 1) R T). Near r = 1 it falls linearly to 0, as the flow function of iso6358 does, so the momentum of the jet is
  // smooth.
  // Source: De Saint-Venant and Wantzel (1839).
  input  Units.AbsolutePressure p_a "Pressure on one side";
  input  Units.AbsolutePressure p_b "Pressure on the other side";
  output Units.Velocity         w   "Speed, not negative";
protected
  constant Units.Exponent kappa    = 1.4 "Isentropic exponent of air";
  constant Units.Exponent e        = (kappa - 1)/kappa;
  constant Units.Fraction r_star   = (2/(kappa + 1))^(1/e);
  constant Units.Fraction r_linear = 0.999;
  Units.Fraction r "Pressure ratio";
algorithm
  r := if p_a >= p_b then p_b/p_a else p_a/p_b;
  w := sqrt(2/e*Air.R*Air.T*(1 - min(max(r, r_star), r_linear)^e))*(if r <= r_linear then 1 else (1 - r)/(1 - r_linear));
end jetSpeed;
