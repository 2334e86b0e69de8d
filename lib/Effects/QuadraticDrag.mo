within Effects;
model QuadraticDrag "Drag with the square of the speed"
  // f = -k v |v|: air or grease pushed through gaps, k = rho c_w A/2. Alone on a mass m: v = v_0/(1 + k v_0 t/m).
  extends PartialDrag;
  parameter Units.QuadraticDragCoefficient k = 0 "Drag per square of the speed";
equation
  f = -k*v*noEvent(abs(v));

  annotation(__mocc(
    effect   = "amplitude=k>0",
    explains = "%at is damped with the square of its speed."));
end QuadraticDrag;
