within Effects;
block ActuatorDelay "Actuator that acts some time after it is asked"
  //   y(t) = u(t - t_d)
  // Dead time: the cycle of a controller or bus, or the way of a medium to where it acts. T_min is short compared with
  // everything; it makes this a delay, which has a derivative by t_d, even where t_d = 0.
  extends PartialActuator;
  parameter Units.Time t_d   = 0    "Dead time";
  parameter Units.Time T_min = 1e-6 "Time that is short compared with all changes";

  Units.Time t = time "Time";
equation
  y = delay(u, t_d + T_min);

  annotation(__mocc(
    effect   = "acts=y; order=first; amplitude=t_d>0; T_min=1e-7*span(t)",
    law      = "y(t) = u(t - t_d)",
    explains = "The signal %at acts after a dead time."));
end ActuatorDelay;
