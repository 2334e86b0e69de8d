within Effects;
model CubicTerm "A term in proportion to the cube of a variable"
  //   term = a x^3
  // A spring that stiffens has this form.
  extends PartialTermOver;
  parameter Real a = 0 "Factor of x^3";
equation
  term = a*x^3;

  annotation(__mocc(
    effect   = "adds=term; amplitude=a",
    law      = "a x^3",
    explains = "The equation of %at lacks a term that grows with the cube of %over."));
end CubicTerm;
