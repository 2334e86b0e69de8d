within Electrical;
model Capacitor "Linear capacitor, perhaps with a resistance in series"
  //   i = C dv_C/dt,   v = v_C + R i
  extends PartialTwoPin;
  parameter Units.Capacitance C           "Capacitance";
  parameter Units.Resistance  R       = 0 "Resistance in series";
  parameter Units.Voltage     v_start = 0 "Voltage at the start";

  Units.Voltage v_C(start = v_start, fixed = true, stateSelect = StateSelect.prefer) "Voltage of the capacitance alone";
equation
  C*der(v_C) = i;
  v = v_C + R*i;

  annotation(__mocc(
    effect   = "amplitude=R>0",
    law      = "i = C dv_C/dt",
    explains = "%at has a resistance in series."));
end Capacitor;
