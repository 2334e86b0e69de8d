within Effects;
block ActuatorLag "Actuator with a store of its own, which approaches what is asked of it"
  //   T dy/dt = u - y
  // An amplifier, a slow valve, or a heating element with a mass. With tau = sqrt(T^2 + T_min^2), where T_min is short
  // compared with everything, the equations y = u - T (u - x)/tau and tau dx/dt = u - x are regular at T = 0 and become
  // the lag of first order beyond T_min.
  extends PartialActuator;
  parameter Units.Time T     = 0    "Time constant";
  parameter Units.Time T_min = 1e-6 "Time that is short compared with all changes";

  Units.Time t   = time                "Time";
  Units.Time tau = sqrt(T^2 + T_min^2) "Time constant of x";
  Real       x                         "Response of a lag of first order with tau";
initial equation
  x = u;
equation
  tau*der(x) = u - x;
  y = u - T*(u - x)/tau;

  annotation(__mocc(
    effect   = "acts=y; amplitude=T>0; T_min=1e-5*span(t)",
    law      = "T dy/dt = u - y",
    explains = "The signal %at acts with a lag."));
end ActuatorLag;
