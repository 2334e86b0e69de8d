within Effects;
model QuadraticTerm "A term in proportion to the square of a variable, with its sign"
  //   term = a x |x|
  // The drag of a body in a turbulent flow has this form.
  extends PartialTermOver;
  parameter Real a = 0 "Factor of x |x|";
equation
  term = a*x*noEvent(abs(x));

  annotation(__mocc(
    effect   = "adds=term; amplitude=a",
    law      = "a x |x|",
    explains = "The equation of %at lacks a term that grows with the square of %over."));
end QuadraticTerm;
