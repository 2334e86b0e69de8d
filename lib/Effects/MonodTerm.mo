within Effects;
model MonodTerm "A term in proportion to a variable and to another one that saturates"
  //   term = A x y/(K + |y|)
  // Growth that needs light and carbon dioxide, a reaction of a substance with an enzyme, uptake by a crop.
  // Source: Monod (1949), "The growth of bacterial cultures", Annual Review of Microbiology 3.
  extends PartialTerm;
  parameter Real A = 0 "Factor of x where y is large";
  parameter Real K = 1 "Magnitude of y at which half of it is reached";

  input Real x "Variable in proportion";
  input Real y "Variable that saturates";
equation
  term = A*x*y/(K + noEvent(abs(y)));

  annotation(__mocc(
    effect   = "adds=term; pairs=ordered; amplitude=A; K=0.1*span(y),0.4*span(y),1.5*span(y)",
    law      = "A x y/(K + |y|)",
    explains = "The equation of %at lacks a term in proportion to the first of %over that saturates over the second."));
end MonodTerm;
