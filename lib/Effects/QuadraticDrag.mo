within Effects;
model QuadraticDrag "Drag proportional to the square of the speed"
  //   f = -k v |v|
  // Air or grease pushed through gaps, k = rho c_w A/2. A mass m with this force alone: v = v_0/(1 + k v_0 t/m).
  extends PartialDrag;
  parameter Units.QuadraticDragCoefficient k = 0 "Drag per square of the speed";
equation
  f = -k*v*noEvent(abs(v));

  annotation(__mocc(
    effect   = "amplitude=k>0",
    law      = "f = -k v |v|",
    explains = "%at is damped with the square of its speed."));
end QuadraticDrag;
