within Effects;
model HeatingVariation "A parameter that follows the square of a quantity with a lag"
  //   p = p_0 (1 + a z),   tau dz/dt = (x/x_0)^2 p/p_0 - z
  // A resistance that its own current heats, a fluid that thins as friction warms it. z is what a store with the time
  // constant tau keeps of the power: 0 at the start, and 1 after a long time at x_0. The power is proportional to the
  // parameter too, as it is for a resistance.
  extends PartialVariation;
  parameter Units.Fraction a   = 0 "Relative change in the end, at x_0";
  parameter Units.Time     tau = 1 "Time constant";
  parameter Real           x_0 = 1 "Magnitude of x for z = 1";

  Units.Time t         = time               "Time";
  Real       size_of_x = noEvent(abs(x))    "Magnitude of x";
  Real       z(start = 0, fixed = true)     "Share that is stored";
equation
  tau*der(z) = (x/x_0)^2*factor - z;
  factor = 1 + a*z;

  annotation(__mocc(
    effect   = "varies=factor; follows=line; amplitude=a; x_0=max(size_of_x); tau=0.05*span(t),0.3*span(t)",
    law      = "1 + a z, tau dz/dt = (x/x_0)^2 (1 + a z) - z",
    explains = "The value of %at follows the square of %over with a lag."));
end HeatingVariation;
