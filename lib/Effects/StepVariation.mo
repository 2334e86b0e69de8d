within Effects;
model StepVariation "A parameter that changes from one recording to the next"
  //   p = p_0 (1 + a) where x > x_s, p_0 elsewhere
  // A part that was exchanged, a repair, a filter that clogged between two recordings: x is the number of the recording.
  extends PartialVariation;
  parameter Units.Fraction a   = 0 "Relative change after x_s";
  parameter Real           x_s = 0 "Value of x at which the parameter changes";
equation
  factor = 1 + a*noEvent(if x > x_s then 1 else 0);

  annotation(__mocc(
    effect   = "varies=factor; follows=line; of=recording; amplitude=a; x_s=between(x)",
    law      = "if x > x_s then 1 + a else 1",
    explains = "The value of %at changes between two recordings."));
end StepVariation;
