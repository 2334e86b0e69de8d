within Effects;
model PositionFriction "Additional Coulomb friction around one position"
  //   |f| = F exp(-((s - s_0)/w)^2) while sliding, and at most that at rest
  // A rough or narrow place in the bore.
  extends PartialFriction;
  parameter Units.Force    F   = 0      "Friction at s_0";
  parameter Units.Position s_0 = 0      "Where it is greatest";
  parameter Units.Length   w   = 0.4e-3 "Width: distance at which 37 % of it acts";
equation
  f_slide = F*exp(-((s - s_0)/w)^2);
  f_static = f_slide;

  annotation(__mocc(
    effect   = "amplitude=F>0; s_0=s(15); w=0.06*span(s),0.15*span(s)",
    law      = "|f| = F exp(-((s - s_0)/w)^2) while sliding, and at most that at rest",
    explains = "%at rubs more around one position."));
end PositionFriction;
