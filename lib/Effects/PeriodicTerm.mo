within Effects;
model PeriodicTerm "A term that returns with each turn"
  //   term = A sin(x) + B cos(x)
  // The weight of an eccentric mass has this form.
  extends PartialTerm;
  input Units.Angle x "Angle that the term depends on";
  parameter Real A = 0 "Factor of the sine, in the unit of the equation";
  parameter Real B = 0 "Factor of the cosine, in the unit of the equation";
equation
  term = A*sin(x) + B*cos(x);

  annotation(__mocc(
    effect   = "adds=term; amplitude=A,B",
    law      = "A sin(x) + B cos(x)",
    explains = "The equation of %at lacks a term that returns with each turn of %over."));
end PeriodicTerm;
