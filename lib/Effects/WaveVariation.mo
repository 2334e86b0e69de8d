within Effects;
model WaveVariation "A parameter that rises and falls periodically with a variable"
  //   p = p_0 (1 + A sin(2 pi x/L) + B cos(2 pi x/L))
  // Seasons over time, eccentricity over an angle. The parameter is its mean over a period.
  extends PartialVariation;
  parameter Units.Fraction A = 0 "Amplitude of the sine";
  parameter Units.Fraction B = 0 "Amplitude of the cosine";
  parameter Real           L = 1 "Period, in the unit of x";
protected
  constant Real two_pi = 6.283185307179586;
equation
  factor = 1 + A*sin(two_pi*x/L) + B*cos(two_pi*x/L);

  annotation(__mocc(
    effect   = "varies=factor; follows=line; amplitude=A,B; L=0.1*span(x),0.14*span(x),0.2*span(x),0.28*span(x),0.4*span(x),0.55*span(x),0.75*span(x),1.05*span(x); simpler=Effects.LinearVariation",
    law      = "1 + A sin(2 pi x/L) + B cos(2 pi x/L)",
    explains = "The value of %at rises and falls periodically with %over."));
end WaveVariation;
