within Effects;
model AccumulationVariation "A parameter that changes in proportion to the time integral of a quantity"
  //   p = p_0 (1 + a e),   de/dt = |x|/(x_0 T),   e(0) = 0
  // The resistance of a filter cake over the volume that has passed, a clearance over the sliding distance. With T the length
  // of the recording, e is 1 after T at x_0.
  extends PartialVariation;
  parameter Units.Fraction a   = 0 "Relative change after T at x_0";
  parameter Real           x_0 = 1 "Magnitude of x for de/dt = 1/T";
  parameter Units.Time     T   = 1 "Time for e = 1 at x_0";

  Units.Time t         = time               "Time";
  Real       size_of_x = noEvent(abs(x))    "Magnitude of x";
  Real       e(start = 0, fixed = true)     "Exposure";
equation
  der(e) = size_of_x/(x_0*T);
  factor = 1 + a*e;

  annotation(__mocc(
    effect   = "varies=factor; follows=line; amplitude=a; x_0=max(size_of_x); T=1*span(t)",
    law      = "1 + a e, de/dt = |x|/(x_0 T)",
    explains = "The value of %at changes in proportion to the time integral of %over."));
end AccumulationVariation;
