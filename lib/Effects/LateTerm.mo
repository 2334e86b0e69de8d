within Effects;
model LateTerm "A term that acts with a lag"
  //   term = y - x,   T dy/dt = x - y
  // x is a term that the equation has; with the new one, y takes its place. As StoredTerm, but in equilibrium at the start.
  extends PartialTermOver;
  parameter Units.Time T     = 0    "Time constant";
  parameter Units.Time T_min = 1e-6 "Time that is short compared with all changes";

  Units.Time t   = time                "Time";
  Units.Time tau = sqrt(T^2 + T_min^2) "Time constant of x_late";
  Real       x_late                    "Response of a lag of first order with tau";
initial equation
  x_late = x;
equation
  tau*der(x_late) = x - x_late;
  term = -T*(x - x_late)/tau;

  annotation(__mocc(
    effect   = "adds=term; of=term; amplitude=T>0; T_min=1e-5*span(t)",
    law      = "y - x, T dy/dt = x - y",
    explains = "In the equation of %at, %over acts with a lag."));
end LateTerm;
