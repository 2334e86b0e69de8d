within Effects;
model CoulombDrag "Additional Coulomb friction"
  //   |f| = F while sliding,   |f| <= F at rest
  // It adds to the friction of the seals, so locking stays exact. A mass m with this friction alone decelerates with
  // F/m and locks after the distance m v_0^2/(2 F).
  extends PartialFriction;
  parameter Units.Force F = 0 "The friction";
equation
  f_slide = F;
  f_static = F;

  annotation(__mocc(
    effect   = "amplitude=F>0",
    law      = "|f| = F while sliding",
    explains = "Coulomb friction that the model does not account for acts on %at."));
end CoulombDrag;
