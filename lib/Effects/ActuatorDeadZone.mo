within Effects;
block ActuatorDeadZone "Actuator that does not follow small values"
  //   y = u - a max(-b, min(b, u))
  // A valve whose edges overlap, an amplifier without bias. With a = 1 nothing acts between -b and b.
  extends PartialActuator;
  parameter Units.Fraction a = 0 "Share of what lies between -b and b that does not act";
  parameter Real           b = 1 "Half the width of the zone, in the unit of u";

  Real size_of_u "Magnitude of u";
equation
  size_of_u = noEvent(abs(u));
  y = u - a*noEvent(max(-b, min(b, u)));

  annotation(__mocc(
    effect   = "acts=y; amplitude=a>0; b=0.03*max(size_of_u),0.1*max(size_of_u),0.3*max(size_of_u)",
    law      = "y = u - a max(-b, min(b, u))",
    explains = "The signal %at acts beyond a dead zone."));
end ActuatorDeadZone;
