within Effects;
model SaturatingTerm "A term that saturates over a variable"
  //   term = A x/(K + |x|)
  // A reaction with an enzyme, growth on a substrate, a predator that has eaten enough, gain that a strong beam uses up.
  // Source: Michaelis and Menten (1913), "Die Kinetik der Invertinwirkung", Biochemische Zeitschrift 49.
  extends PartialTermOver;
  parameter Real A = 0 "The term where x is large";
  parameter Real K = 1 "Magnitude of x at which half of it is reached";
equation
  term = A*x/(K + noEvent(abs(x)));

  annotation(__mocc(
    effect   = "adds=term; amplitude=A; K=0.05*span(x),0.2*span(x),0.8*span(x); simpler=Effects.LinearTerm",
    law      = "A x/(K + |x|)",
    explains = "The equation of %at lacks a term that saturates over %over."));
end SaturatingTerm;
