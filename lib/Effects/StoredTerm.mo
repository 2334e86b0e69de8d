within Effects;
model StoredTerm "A term that passes a store, empty at the start, before it acts"
  //   term = y - x,   T dy/dt = x - y,   y(0) = 0
  // x is a term that the equation has; with the new one, y takes its place. Those infected who do not infect others yet, what
  // is poured in and has to dissolve. With tau = sqrt(T^2 + T_min^2), where T_min is short compared with everything, the
  // equations are regular at T = 0.
  extends PartialTermOver;
  parameter Units.Time T     = 0    "Time constant";
  parameter Units.Time T_min = 1e-6 "Time that is short compared with all changes";

  Units.Time t   = time                  "Time";
  Units.Time tau = sqrt(T^2 + T_min^2)   "Time constant of x_late";
  Real       x_late(start = 0, fixed = true) "Response of a store with tau";
equation
  tau*der(x_late) = x - x_late;
  term = -T*(x - x_late)/tau;

  annotation(__mocc(
    effect   = "adds=term; of=term; amplitude=T>0; T_min=1e-5*span(t)",
    law      = "y - x, T dy/dt = x - y, y(0) = 0",
    explains = "In the equation of %at, %over passes a store that is empty at the start."));
end StoredTerm;
