within Effects;
model CoulombDrag "Dry friction, always and everywhere the same"
  // F against the motion, and up to F at rest. Alone on a mass m its speed falls with F/m until it locks, after the
  // way m v_0^2/(2 F). It adds to what the spool's seals can hold, so locking stays exact.
  extends PartialFriction;
  parameter Units.Force F = 0 "The friction";
equation
  f_slide = F;
  f_static = F;

  annotation(__mocc(
    effect   = "amplitude=F>0",
    explains = "Dry friction that nothing in the model accounts for acts on %at."));
end CoulombDrag;
