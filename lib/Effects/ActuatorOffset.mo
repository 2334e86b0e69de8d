within Effects;
block ActuatorOffset "Actuator with an offset"
  //   y = u + offset
  extends PartialActuator;
  parameter Real offset = 0 "Value that acts at u = 0, in the unit of u";
equation
  y = u + offset;

  annotation(__mocc(
    effect   = "acts=y; amplitude=offset",
    law      = "y = u + offset",
    explains = "The signal %at acts with an offset."));
end ActuatorOffset;
