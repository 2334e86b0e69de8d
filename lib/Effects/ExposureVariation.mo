within Effects;
model ExposureVariation "A parameter that grows or falls with the time integral of a quantity"
  //   p = p_0 exp(k e),   de/dt = |x|/(x_0 T),   e(0) = 0
  // Wear over the sliding distance, a catalyst over the amount that it has converted, frost or fouling over the heat that
  // has passed, an aging cell over the charge. With T the length of the recording, e is 1 after T at x_0.
  extends PartialVariation;
  parameter Real       k   = 0 "Logarithm of the relative change after T at x_0";
  parameter Real       x_0 = 1 "Magnitude of x for de/dt = 1/T";
  parameter Units.Time T   = 1 "Time for e = 1 at x_0";

  Units.Time t         = time               "Time";
  Real       size_of_x = noEvent(abs(x))    "Magnitude of x";
  Real       e(start = 0, fixed = true)     "Exposure";
equation
  der(e) = size_of_x/(x_0*T);
  factor = exp(k*e);

  annotation(__mocc(
    effect   = "varies=factor; follows=line; amplitude=k; x_0=max(size_of_x); T=1*span(t); simpler=Effects.AccumulationVariation",
    law      = "exp(k e), de/dt = |x|/(x_0 T)",
    explains = "The value of %at grows or falls with the time integral of %over."));
end ExposureVariation;
