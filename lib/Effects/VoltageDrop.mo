within Effects;
model VoltageDrop "Voltage that a resistor loses in either direction, as at a contact or at brushes"
  //   i = -G max(-V, min(V, v))
  // Together with a resistor 1/G, no current flows below the voltage V, and G (|v| - V) above.
  extends PartialBranch;
  parameter Units.ElectricConductance G = 0   "Conductance that is missing below V";
  parameter Units.Voltage             V = 0.1 "The voltage that is lost";

  Units.Voltage size_of_v "Magnitude of v";
equation
  size_of_v = noEvent(abs(v));
  i = -G*noEvent(max(-V, min(V, v)));

  annotation(__mocc(
    effect   = "series=true; amplitude=G>0; V=0.03*max(size_of_v),0.1*max(size_of_v),0.3*max(size_of_v)",
    law      = "i = -G max(-V, min(V, v))",
    explains = "A constant voltage is lost at %at in either direction, as at a contact."));
end VoltageDrop;
