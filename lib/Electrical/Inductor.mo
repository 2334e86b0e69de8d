within Electrical;
model Inductor "Linear inductor, perhaps with the resistance of its winding"
  //   v = L di/dt + R i
  extends PartialTwoPin(i(start = i_start, fixed = true, stateSelect = StateSelect.prefer));
  parameter Units.Inductance L           "Inductance";
  parameter Units.Resistance R       = 0 "Resistance of the winding";
  parameter Units.Current    i_start = 0 "Current at the start";
equation
  v = L*der(i) + R*i;

  annotation(__mocc(
    effect   = "amplitude=R>0",
    law      = "v = L di/dt + R i",
    explains = "The winding of %at has a resistance."));
end Inductor;
