within Effects;
model ConstantTorque "Constant torque"
  //   tau = M
  // A load, an unbalanced weight at a small angle, or the offset of a drive.
  extends PartialTorque;
  parameter Units.Torque M = 0 "The torque, positive towards +phi";
equation
  tau = M;

  annotation(__mocc(
    effect   = "amplitude=M",
    law      = "tau = M",
    explains = "A constant torque acts on %at."));
end ConstantTorque;
