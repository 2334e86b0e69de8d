within Effects;
block ActuatorRateLimit "Actuator that changes no faster than a certain rate"
  //   y = u - a (u - x),   |dx/dt| <= r_max
  // A drive with a greatest speed, a heater whose power is ramped. x follows u within T_min, which is short compared with
  // everything, unless u changes faster than r_max. With a = 1 only x acts; with a smaller a, the rest of u still does.
  extends PartialActuator;
  parameter Units.Fraction a     = 0    "Share of what is beyond the rate that does not act";
  parameter Real           r_max = 1    "Greatest rate, in the unit of u per second";
  parameter Units.Time     T_min = 1e-6 "Time that is short compared with all changes";

  Units.Time t = time "Time";
  Real       x        "Value that follows no faster than r_max, in the unit of u";
initial equation
  x = u;
equation
  der(x) = noEvent(max(-r_max, min(r_max, (u - x)/T_min)));
  y = u - a*(u - x);

  annotation(__mocc(
    effect   = "acts=y; amplitude=a>0; r_max=2*span(u)/span(t),7*span(u)/span(t),25*span(u)/span(t),90*span(u)/span(t),300*span(u)/span(t); T_min=1e-5*span(t)",
    law      = "y = u - a (u - x), |dx/dt| <= r_max",
    explains = "The signal %at acts no faster than at a greatest rate."));
end ActuatorRateLimit;
