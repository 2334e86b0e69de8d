within Effects;
model CompliantStop "Elastic, damped contact near an end of the stroke"
  //   f = x_c (c + d v_in) away from the end,   x_c = max(0, w - x)
  // x_c is the depth of penetration into a pad of thickness w in front of the stop. The damping is proportional to
  // the depth, so the force starts and ends at 0.
  // Source: Hunt and Crossley (1975), "Coefficient of restitution interpreted as damping in vibroimpact", Journal of
  // Applied Mechanics 42(2).
  extends PartialEnd;
  parameter Units.SpringStiffness c = 0      "Stiffness";
  parameter Units.ContactDamping  d = 0      "Damping per depth";
  parameter Units.Length          w = 0.2e-3 "Where the contact begins: distance from the end";

  Units.Length x_c "Depth of penetration";
equation
  x_c = noEvent(max(0, w - x));
  f = (if side > 0 then -1 else 1)*x_c*(c + d*v_in);

  annotation(__mocc(
    effect   = "amplitude=c>0,d>0; side=-1,1; s_lo=min(s); s_hi=max(s); w=0.03*span(s),0.06*span(s),0.15*span(s)",
    law      = "f = x_c (c + d v_in) away from the end",
    explains = "%at meets an elastic stop before an end of its stroke."));
end CompliantStop;
