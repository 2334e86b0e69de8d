within Effects;
model ConstantForce "Constant force"
  //   f = F
  // A weight, a bias spring, or the offset of a pressure.
  extends PartialForce;
  parameter Units.Force F = 0 "The force, positive towards +s";
equation
  f = F;

  annotation(__mocc(
    effect   = "amplitude=F",
    law      = "f = F",
    explains = "A constant force acts on %at."));
end ConstantForce;
