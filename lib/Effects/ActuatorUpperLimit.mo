within Effects;
block ActuatorUpperLimit "Actuator that gives no more than a certain value, though it may give less than nothing"
  //   y = u - a max(0, u - y_max)
  // A drive that may pull but hardly push. With a = 1 nothing beyond y_max acts. The corner is rounded over delta, a
  // small share of the negative values: where u has none, ActuatorLimit says the same.
  extends PartialActuator;
  parameter Units.Fraction a     = 0    "Share of what exceeds y_max that does not act";
  parameter Real           y_max = 1    "Limit, in the unit of u";
  parameter Real           delta = 1e-6 "Width of the corner, in the unit of u";

  Real below_zero "The negative part of u";
equation
  below_zero = noEvent(min(0, u));
  y = u - a*(u - y_max + sqrt((u - y_max)^2 + delta^2))/2;

  annotation(__mocc(
    effect   = "acts=y; amplitude=a>0; y_max=u(6); delta=1e-4*span(below_zero)",
    law      = "y = u - a max(0, u - y_max)",
    explains = "The signal %at acts up to a greatest value."));
end ActuatorUpperLimit;
