within Effects;
model Detent "Force that holds the body at one position, or pushes it away"
  //   f = -F x exp((1 - x^2)/2),   x = (s - s_0)/w
  // The slope of a bell-shaped potential, as of a ball in a groove. The force pulls towards s_0 from both sides, with
  // the maximum F at s_0 +- w; a negative F pushes away. Stiffness at s_0: F sqrt(e)/w. Work from s_0 to infinity: F
  // w sqrt(e).
  extends PartialForce;
  parameter Units.Force    F   = 0      "Greatest force";
  parameter Units.Position s_0 = 0      "Where it holds";
  parameter Units.Length   w   = 0.2e-3 "Distance from s_0 at which it is greatest";

  Units.Exponent x "Distance from s_0 in widths";
equation
  x = (s - s_0)/w;
  f = -F*x*exp((1 - x^2)/2);

  annotation(__mocc(
    effect   = "amplitude=F; s_0=s(15); w=0.03*span(s),0.06*span(s),0.12*span(s)",
    law      = "f = -F x exp((1 - x^2)/2)",
    explains = "A detent holds %at around one position."));
end Detent;
