within Effects;
block ActuatorUpperLimit "Actuator that gives no more than a certain value"
  //   y = u - a max(0, u - y_max)
  // A drive that may push but hardly pull, a heater at its rated power. With a = 1 nothing beyond y_max acts.
  extends PartialActuator;
  parameter Units.Fraction a     = 0 "Share of what exceeds y_max that does not act";
  parameter Real           y_max = 1 "Limit, in the unit of u";
equation
  y = u - a*noEvent(max(0, u - y_max));

  annotation(__mocc(
    effect   = "acts=y; amplitude=a>0; y_max=u(6)",
    law      = "y = u - a max(0, u - y_max)",
    explains = "The input %at acts up to a greatest value."));
end ActuatorUpperLimit;
