within Effects;
model ClampDiode "Diode past a component that limits its voltage"
  //   i = G max(0, v - V) for voltages from p to n
  // A Zener diode, the protection of an input, or a breakdown: nothing flows below the voltage V.
  extends PartialBranch;
  parameter Integer                   side = 1 "+1 if it limits p.v - n.v, -1 if n.v - p.v";
  parameter Units.ElectricConductance G    = 0 "Conductance above V";
  parameter Units.Voltage             V    = 1 "Voltage at which it begins to conduct";

  Units.Voltage size_of_v "Magnitude of v";
equation
  size_of_v = noEvent(abs(v));
  i = G*(if side > 0 then noEvent(max(0, v - V)) else noEvent(min(0, v + V)));

  annotation(__mocc(
    effect   = "amplitude=G>0; side=-1,1; V=0.3*max(size_of_v),0.5*max(size_of_v),0.7*max(size_of_v),0.9*max(size_of_v)",
    law      = "i = G max(0, v - V) for voltages from p to n",
    explains = "A diode limits the voltage of %at."));
end ClampDiode;
