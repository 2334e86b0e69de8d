within Effects;
block ActuatorLimit "Actuator that stops at its largest value"
  //   y = u - a (u - max(-y_max, min(y_max, u)))
  // An amplifier at its supply voltage, a valve that is fully open. With a = 1 nothing beyond y_max acts; with a smaller
  // a, the rest of it still does.
  extends PartialActuator;
  parameter Units.Fraction a     = 0 "Share of what exceeds y_max that does not act";
  parameter Real           y_max = 1 "Largest value, in the unit of u";

  Real size_of_u "Magnitude of u";
equation
  size_of_u = noEvent(abs(u));
  y = u - a*(u - noEvent(max(-y_max, min(y_max, u))));

  annotation(__mocc(
    effect   = "acts=y; amplitude=a>0; y_max=0.3*max(size_of_u),0.5*max(size_of_u),0.7*max(size_of_u),0.9*max(size_of_u)",
    law      = "y = u - a (u - max(-y_max, min(y_max, u)))",
    explains = "The signal %at acts up to a limit."));
end ActuatorLimit;
