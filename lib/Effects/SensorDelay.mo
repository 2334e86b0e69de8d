within Effects;
block SensorDelay "Sensor that reads early or late"
  // y = u - t_d du/dt: the first term of Taylor's series of u(t - t_d), good while t_d is short against the changes
  // of u. u must be continuous. Negative if the sensor's clock is ahead.
  parameter Units.Time t_d = 0 "Delay";

  input Real  u "What is measured, in any unit";
  output Real y "What the sensor says, in the same unit";
equation
  y = u - t_d*der(u);

  annotation(__mocc(
    effect   = "amplitude=t_d",
    explains = "The sensor of %at reads late, or early."));
end SensorDelay;
