within Effects;
model OffsetCurrent "Constant current into the circuit"
  //   i = I
  // The bias current of an amplifier, or a consumer that the model does not have (negative).
  extends PartialInjection;
  parameter Units.Current I = 0 "The current";
equation
  i = I;

  annotation(__mocc(
    effect   = "amplitude=I",
    law      = "i = I",
    explains = "A constant current enters the circuit at %at, or leaves it there if negative."));
end OffsetCurrent;
