within Effects;
model ViscousDrag "Damping in proportion to speed"
  // f = -d v: shear of a film of grease, eddy currents. Alone on a mass m its speed falls as exp(-d t/m).
  extends PartialDrag;
  parameter Units.DampingCoefficient d = 0 "Damping coefficient";
equation
  f = -d*v;

  annotation(__mocc(
    effect   = "amplitude=d>0",
    explains = "%at is damped in proportion to its speed."));
end ViscousDrag;
