within Effects;
model WallHeat "Air that warms when compressed and cools at the wall"
  //   dtheta/dt = (kappa - 1)/kappa (dp/dt)/p - theta/tau
  //   m = p V/(R T) (1 - k theta)
  // The temperature T (1 + theta) of the air follows the pressure adiabatically and relaxes to that of the wall. k =
  // 1 is the full effect, to first order in theta. Slow changes (tau dp/dt small compared with p) are isothermal,
  // fast ones adiabatic. tau = m c_p/(h A) for the heat transfer coefficient h at the wall area A.
  // Source: Beater (2007), "Pneumatic Drives".
  extends PartialStorage;
  parameter Units.Fraction k   = 0     "Share of the full effect";
  parameter Units.Time     tau = 10e-3 "Time constant of the heat transfer";

  input Units.Volume V "Volume of the host";
  Units.Fraction theta(start = 0, fixed = true) "Excess of its temperature, as a share of T";
  Units.Mass     m_less                         "Air that warming displaces";
  Units.Time     t = time                       "Time";
  constant Units.Exponent kappa = 1.4 "Isentropic exponent of air";
equation
  der(theta) = (kappa - 1)/kappa*der(p)/p - theta/tau;
  m_less = p*V*theta/(Pneumatics.Air.R*Pneumatics.Air.T);
  m_flow = -k*der(m_less);

  annotation(__mocc(
    effect   = "amplitude=k>0; host=port; bind V=V; tau=0.025*span(t),0.08*span(t),0.25*span(t)",
    law      = "dtheta/dt = (kappa - 1)/kappa (dp/dt)/p - theta/tau",
    explains = "The air in %at warms when it is compressed and cools at the wall."));
end WallHeat;
