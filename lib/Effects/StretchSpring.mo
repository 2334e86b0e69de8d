within Effects;
model StretchSpring "Spring between two bodies, in addition to existing ones"
  //   f = F_0 + c s_rel
  // Two masses m with this spring alone oscillate against each other with sqrt(2 c/m).
  extends PartialStretch;
  parameter Units.SpringStiffness c   = 0 "Stiffness";
  parameter Units.Force           F_0 = 0 "Force at the distance 0";
equation
  f = F_0 + c*s_rel;

  annotation(__mocc(
    effect   = "between=moving; amplitude=c>0,F_0",
    law      = "f = F_0 + c s_rel",
    explains = "A spring acts across %at."));
end StretchSpring;
