within Pneumatics;
model Volume "Isothermal air in a rigid volume"
  //   m = p V/(R T),   dm/dt = m_flow
  parameter Units.Volume V_0 "Volume";
  extends PartialVolume(final V_nominal = V_0);
equation
  V = V_0;
end Volume;
