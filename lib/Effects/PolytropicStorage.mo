within Effects;
model PolytropicStorage "Air that warms when it is compressed: polytropic instead of isothermal"
  // m_flow = -k V/(R T) dp/dt. With p V^n = const. for the air within, the mass in the volume changes by V/(n R T)
  // dp/dt + p/(R T) dV/dt, of which the isothermal volume has k = 1 - 1/n too much: 0 isothermal, 0.286 adiabatic
  // (n = 1.4). Beater (2007), "Pneumatic Drives".
  extends PartialStorage;
  parameter Units.Fraction k = 0 "1 - 1/n: 0 isothermal, 0.286 adiabatic";

  input Units.Volume V "Volume of the host";
equation
  m_flow = -k*V/(Pneumatics.Air.R*Pneumatics.Air.T)*der(p);

  annotation(__mocc(
    effect   = "amplitude=k>0; host=port; bind V=V",
    explains = "The air in %at warms when it is compressed."));
end PolytropicStorage;
