within Effects;
model RelaxationTerm "A term that follows a variable with a lag"
  //   term = a y,   tau dy/dt = x - y,   y(0) = 0
  // A second resistance with its capacitor, a wall that is heated and heats, a drug that comes back from a tissue. As
  // RelaxationBranch, for a model whose balances are equations.
  extends PartialTermOver;
  parameter Real       a   = 0 "The term per x where x has been constant for long";
  parameter Units.Time tau = 1 "Time constant";

  Units.Time t = time                   "Time";
  Real       y(start = 0, fixed = true) "Response of a lag of first order";
equation
  tau*der(y) = x - y;
  term = a*y;

  annotation(__mocc(
    effect   = "adds=term; amplitude=a; tau=0.003*span(t),0.02*span(t),0.15*span(t); simpler=Effects.LinearTerm",
    law      = "a y, tau dy/dt = x - y, y(0) = 0",
    explains = "The equation of %at lacks a term that follows %over with a lag."));
end RelaxationTerm;
