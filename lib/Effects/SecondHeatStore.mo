within Effects;
model SecondHeatStore "Heat capacity behind a conductance"
  //   Q_flow = -C (T - T_2)/tau,   tau dT_2/dt = T - T_2
  // A part of the body, or something that touches it, that warms later: insulation, a holder, a filling. The conductance
  // is C/tau. At the start it has the temperature of the body.
  extends PartialHeat;
  parameter Units.HeatCapacity C   = 0 "Heat capacity";
  parameter Units.Time         tau = 1 "Time constant";

  Units.Time        t = time "Time";
  Units.Temperature T_2      "Temperature of the second store";
initial equation
  T_2 = T;
equation
  tau*der(T_2) = T - T_2;
  Q_flow = -C*(T - T_2)/tau;

  annotation(__mocc(
    effect   = "amplitude=C>0; tau=0.01*span(t),0.05*span(t),0.3*span(t)",
    law      = "Q_flow = -C (T - T_2)/tau",
    explains = "Something that stores heat warms and cools behind %at."));
end SecondHeatStore;
