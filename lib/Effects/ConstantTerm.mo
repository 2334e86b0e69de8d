within Effects;
model ConstantTerm "A constant term"
  //   term = a
  extends PartialTerm;
  parameter Real a = 0 "The term, in the unit of the equation";
equation
  term = a;

  annotation(__mocc(
    effect   = "adds=term; amplitude=a",
    law      = "a",
    explains = "The equation of %at lacks a constant term."));
end ConstantTerm;
