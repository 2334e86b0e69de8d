within Effects;
block ActuatorPartialLag "Actuator that follows in part at once and in part with a lag"
  //   y = u - T (u - x)/tau,   tau dx/dt = u - x
  // A slow change acts T late. T = tau is ActuatorLag; with another T, a part of the change acts at once. In a loop, a long
  // lag changes much that a short one does not, so several time constants are tried.
  extends PartialActuator;
  parameter Units.Time T   = 0    "How late a slow change acts";
  parameter Units.Time tau = 1e-3 "Time constant";

  Units.Time t = time "Time";
  Real       x        "Response of a lag of first order with tau";
initial equation
  x = u;
equation
  tau*der(x) = u - x;
  y = u - T*(u - x)/tau;

  annotation(__mocc(
    effect   = "acts=y; amplitude=T>0; tau=0.0025*span(t),0.008*span(t),0.025*span(t); named=Effects.ActuatorLag",
    law      = "y = u - T (u - x)/tau",
    explains = "The signal %at acts with a lag."));
end ActuatorPartialLag;
