within Effects;
block ActuatorLowerLimit "Actuator that gives no less than a certain value"
  //   y = u - a min(0, u - y_min)
  // A brake whose energy the battery cannot take, a valve that does not close, a pump that cannot suck. With a = 1
  // nothing below y_min acts.
  extends PartialActuator;
  parameter Units.Fraction a     = 0 "Share of what lies below y_min that does not act";
  parameter Real           y_min = 1 "Limit, in the unit of u";
equation
  y = u - a*noEvent(min(0, u - y_min));

  annotation(__mocc(
    effect   = "acts=y; amplitude=a>0; y_min=u(6)",
    law      = "y = u - a min(0, u - y_min)",
    explains = "The signal %at acts down to a least value."));
end ActuatorLowerLimit;
