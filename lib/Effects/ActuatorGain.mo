within Effects;
block ActuatorGain "Actuator with another gain"
  //   y = (1 + g) u
  extends PartialActuator;
  parameter Units.Fraction g = 0 "Relative error of the gain";
equation
  y = (1 + g)*u;

  annotation(__mocc(
    effect   = "acts=y; amplitude=g",
    law      = "y = (1 + g) u",
    explains = "The signal %at acts with another gain."));
end ActuatorGain;
