within Effects;
model ConstantForce "Force that never changes"
  // f = F: a weight, a bias spring, an offset of a pressure that nothing else sees.
  extends PartialForce;
  parameter Units.Force F = 0 "The force, positive towards +s";
equation
  f = F;

  annotation(__mocc(
    effect   = "amplitude=F",
    explains = "A constant force acts on %at."));
end ConstantForce;
