within Electrical;
model Voltage "Voltage source, given by an input"
  //   v = v_0 + R i
  // i is the current from p to n through the source, negative while it delivers power.
  extends PartialTwoPin;
  parameter Units.Resistance R = 0 "Internal resistance";
  input Units.Voltage v_0 "Voltage without a load";
equation
  v = v_0 + R*i;

  annotation(__mocc(
    effect   = "amplitude=R>0",
    law      = "v = v_0 + R i",
    explains = "The voltage of %at drops under load: it has a resistance in series."));
end Voltage;
