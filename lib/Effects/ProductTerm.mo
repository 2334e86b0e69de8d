within Effects;
model ProductTerm "A term in proportion to the product of two variables"
  //   term = a x y
  extends PartialTermOver;
  input Real y "The other variable";
  parameter Real a = 0 "Factor of x y";
equation
  term = a*x*y;

  annotation(__mocc(
    effect   = "adds=term; amplitude=a",
    law      = "a x y",
    explains = "The equation of %at lacks a term in proportion to the product of %over."));
end ProductTerm;
