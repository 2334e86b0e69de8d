within Effects;
model DeadVolume "Volume that the sheet does not know"
  // m_flow = V/(R T) dp/dt: isothermal air. It has no state of its own, so the port must belong to a volume, whose
  // pressure it shares from the start.
  extends PartialStorage;
  parameter Units.Volume V = 0 "Additional volume";
equation
  m_flow = V/(Pneumatics.Air.R*Pneumatics.Air.T)*der(p);

  annotation(__mocc(
    effect   = "amplitude=V>0",
    explains = "The volume at %at is greater than the sheet says."));
end DeadVolume;
