within Effects;
block ActuatorEmptyStore "Store between a signal and what it acts on, empty at the start"
  //   T dy/dt = u - y,   y(0) = 0
  // Those infected who do not infect others yet, a conveyor that starts empty, a pipe that has to warm up. Equal to
  // ActuatorLag but for its start: there, what was asked before the recording has arrived.
  extends PartialActuator;
  parameter Units.Time T     = 0    "Time constant";
  parameter Units.Time T_min = 1e-6 "Time that is short compared with all changes";

  Units.Time t   = time                "Time";
  Units.Time tau = sqrt(T^2 + T_min^2) "Time constant of x";
  Real       x(start = 0, fixed = true) "Response of a lag of first order with tau";
equation
  tau*der(x) = u - x;
  y = u - T*(u - x)/tau;

  annotation(__mocc(
    effect   = "acts=y; amplitude=T>0; T_min=1e-5*span(t)",
    law      = "T dy/dt = u - y, y(0) = 0",
    explains = "The signal %at passes a store that is empty at the start."));
end ActuatorEmptyStore;
