within Effects;
model PolytropicStorage "Air that warms when compressed: polytropic instead of isothermal"
  //   m_flow = -k V/(R T) dp/dt,   k = 1 - 1/n
  // With p V^n = const. the mass in the volume changes by V/(n R T) dp/dt + p/(R T) dV/dt; the isothermal volume has
  // the fraction k too much. k = 0 is isothermal, k = 0.286 adiabatic (n = 1.4).
  // Source: Beater (2007), "Pneumatic Drives".
  extends PartialStorage;
  parameter Units.Fraction k = 0 "1 - 1/n: 0 isothermal, 0.286 adiabatic";

  input Units.Volume V "Volume of the host";
equation
  m_flow = -k*V/(Pneumatics.Air.R*Pneumatics.Air.T)*der(p);

  annotation(__mocc(
    effect   = "amplitude=k>0; host=port; bind V=V",
    law      = "m_flow = -k V/(R T) dp/dt",
    explains = "The air in %at warms when it is compressed."));
end PolytropicStorage;
