within Effects;
model HysteresisTerm "A term with hysteresis over a variable"
  //   term = A z,   w dz/dt = dp/dt - |dp/dt| z
  // After a path long compared with w, z is +1 where x grows and -1 where it falls, whatever its speed: Duhem's form of
  // hysteresis, with the slope of Dahl's friction. The path p follows x with a short lag, so that x may jump. Over the charge
  // of a cell it is the hysteresis of its open-circuit voltage.
  // Source: Plett (2004), "Extended Kalman filtering for battery management systems of LiPB-based HEV battery packs, part 2",
  // Journal of Power Sources 134, section 3.3 (one-state hysteresis).
  extends PartialTermOver;
  parameter Real       A     = 0    "The term where x grows, in the unit of the equation";
  parameter Real       w     = 1    "Path after which 63 % of it is reached, in the unit of x";
  parameter Units.Time T_min = 1e-6 "How late the path is known";

  Units.Time     t = time                   "Time";
  Real           p                          "Path, in the unit of x";
  Units.Fraction z(start = 0, fixed = true) "Position between the branches, -1 to 1";
initial equation
  p = x;
equation
  T_min*der(p) = x - p;
  w*der(z) = der(p) - noEvent(abs(der(p)))*z;
  term = A*z;

  annotation(__mocc(
    effect   = "adds=term; amplitude=A; w=0.02*span(x),0.1*span(x),0.4*span(x); T_min=1e-5*span(t)",
    law      = "A z,  w dz/dt = dx/dt - |dx/dt| z",
    explains = "The equation of %at lacks a term with hysteresis over %over."));
end HysteresisTerm;
