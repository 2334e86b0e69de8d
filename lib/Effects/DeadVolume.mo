within Effects;
model DeadVolume "Additional volume"
  //   m_flow = V/(R T) dp/dt
  // Isothermal air. The effect has no state of its own: its port must be connected to a volume, whose pressure it
  // shares from the start.
  extends PartialStorage;
  parameter Units.Volume V = 0 "Additional volume";
equation
  m_flow = V/(Pneumatics.Air.R*Pneumatics.Air.T)*der(p);

  annotation(__mocc(
    effect   = "amplitude=V>0",
    law      = "m_flow = V/(R T) dp/dt",
    explains = "The volume at %at is greater than specified."));
end DeadVolume;
