within Effects;
block ActuatorDelay "Actuator that acts some time after it is asked"
  //   y(t) = u(t - t_d)
  // Dead time: the cycle of a controller or bus, or the way of a medium to where it acts.
  extends PartialActuator;
  parameter Units.Time t_d = 0 "Dead time";
equation
  y = delay(u, t_d);

  annotation(__mocc(
    effect   = "acts=y; amplitude=t_d>0",
    law      = "y(t) = u(t - t_d)",
    explains = "The input %at acts after a dead time."));
end ActuatorDelay;
