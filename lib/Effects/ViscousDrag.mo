within Effects;
model ViscousDrag "Damping proportional to the speed"
  //   f = -d v
  // Shear of a film of grease, or eddy currents. A mass m with this force alone slows down as exp(-d t/m).
  extends PartialDrag;
  parameter Units.DampingCoefficient d = 0 "Damping coefficient";
equation
  f = -d*v;

  annotation(__mocc(
    effect   = "amplitude=d>0",
    law      = "f = -d v",
    explains = "%at is damped in proportion to its speed."));
end ViscousDrag;
