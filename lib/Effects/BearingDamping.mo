within Effects;
model BearingDamping "Viscous friction: a torque proportional to the speed"
  //   tau = -d w
  // Oil or grease in a bearing, or eddy currents. An inertia J with this torque alone slows down as exp(-d t/J).
  extends PartialBearing;
  parameter Units.RotationalDamping d = 0 "Damping coefficient";
equation
  tau = -d*w;

  annotation(__mocc(
    effect   = "amplitude=d>0",
    law      = "tau = -d w",
    explains = "%at is damped in proportion to its speed, as by grease in a bearing."));
end BearingDamping;
