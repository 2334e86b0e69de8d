within Effects;
model DiodeDrop "Diode in series with a resistor"
  //   i = -G min(v, V) for currents from p to n
  // Together with a resistor 1/G, current flows in one direction only and begins at the voltage V: a diode with a sharp
  // bend.
  extends PartialBranch;
  parameter Integer                   side = 1   "+1 if current may flow from p to n, -1 if from n to p";
  parameter Units.ElectricConductance G    = 0   "Conductance of the resistor";
  parameter Units.Voltage             V    = 0.1 "Forward voltage of the diode";

  Units.Voltage size_of_v "Magnitude of v";
equation
  size_of_v = noEvent(abs(v));
  i = -G*(if side > 0 then noEvent(min(v, V)) else noEvent(max(v, -V)));

  annotation(__mocc(
    effect   = "series=true; amplitude=G>0; side=-1,1; V=0.03*max(size_of_v),0.1*max(size_of_v),0.3*max(size_of_v)",
    law      = "i = -G min(v, V) for currents from p to n",
    explains = "A diode in series with %at passes current in one direction only, and takes its forward voltage."));
end DiodeDrop;
