within Effects;
block SensorDelay "Sensor that reads late or early"
  //   y = u - t_d du/dt
  // The first term of the Taylor series of u(t - t_d), valid while t_d is short compared with the changes of u. u
  // must be continuous. t_d is negative if the clock of the sensor is ahead.
  parameter Units.Time t_d = 0 "Delay";

  input Real  u "Simulated value, in any unit";
  output Real y "Reading, in the same unit";
equation
  y = u - t_d*der(u);

  annotation(__mocc(
    effect   = "amplitude=t_d",
    law      = "y = u - t_d du/dt",
    explains = "The sensor of %at reads late or early."));
end SensorDelay;
