within Effects;
model LeakConductance "Current past a component, proportional to the voltage"
  //   i = G v
  // Damp or dirty insulation, or the input of an instrument. A capacitor C with this leak alone is discharged as exp(-G
  // t/C).
  extends PartialBranch;
  parameter Units.ElectricConductance G = 0 "Conductance";
equation
  i = G*v;

  annotation(__mocc(
    effect   = "amplitude=G>0",
    law      = "i = G v",
    explains = "A current leaks past %at."));
end LeakConductance;
