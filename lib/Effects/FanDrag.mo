within Effects;
model FanDrag "Drag torque proportional to the square of the speed"
  //   tau = -k w |w|
  // A fan, a propeller, or churning of a liquid. An inertia J with this torque alone: w = w_0/(1 + k w_0 t/J).
  extends PartialBearing;
  parameter Units.QuadraticRotationalDrag k = 0 "Drag torque per square of the speed";
equation
  tau = -k*w*noEvent(abs(w));

  annotation(__mocc(
    effect   = "amplitude=k>0",
    law      = "tau = -k w |w|",
    explains = "%at is damped with the square of its speed, as by a fan."));
end FanDrag;
