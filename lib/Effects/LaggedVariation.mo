within Effects;
model LaggedVariation "A parameter that follows a quantity with a lag"
  //   p = p_0 (1 + a z),   tau dz/dt = (x - x_lo)/(x_hi - x_lo) - z
  // A viscosity in an oil that warms up slowly, a clearance that follows the temperature of its housing. At the start, z
  // has followed already.
  extends PartialVariation;
  parameter Units.Fraction a    = 0 "Relative increase from x_lo to x_hi";
  parameter Units.Time     tau  = 1 "Time constant";
  parameter Real           x_lo = 0 "Value of x at which the parameter is itself in the end";
  parameter Real           x_hi = 1 "Value of x at which the parameter has grown by a in the end";

  Units.Time t = time "Time";
  Real       z        "x from x_lo to x_hi as 0 to 1, with a lag";
initial equation
  z = (x - x_lo)/(x_hi - x_lo);
equation
  tau*der(z) = (x - x_lo)/(x_hi - x_lo) - z;
  factor = 1 + a*z;

  annotation(__mocc(
    effect   = "varies=factor; follows=line; amplitude=a; x_lo=min(x); x_hi=max(x); tau=0.05*span(t),0.3*span(t); simpler=Effects.LinearVariation,Effects.AccumulationVariation,Effects.ExposureVariation",
    law      = "1 + a z, tau dz/dt = (x - x_lo)/(x_hi - x_lo) - z",
    explains = "The value of %at follows %over with a lag."));
end LaggedVariation;
