within Effects;
model LinearTerm "A term in proportion to a variable"
  //   term = a x
  extends PartialTermOver;
  parameter Real a = 0 "Factor of x";
equation
  term = a*x;

  annotation(__mocc(
    effect   = "adds=term; amplitude=a",
    law      = "a x",
    explains = "The equation of %at lacks a term in proportion to %over."));
end LinearTerm;
