within Effects;
model StretchDamping "Damping between two bodies, in addition to existing dampers"
  //   f = d v_rel
  // The difference of the speeds of two masses m with this damper alone decays as exp(-2 d t/m).
  extends PartialStretchRate;
  parameter Units.DampingCoefficient d = 0 "Damping coefficient";
equation
  f = d*v_rel;

  annotation(__mocc(
    effect   = "between=moving; amplitude=d>0",
    law      = "f = d v_rel",
    explains = "The deflection of %at is damped."));
end StretchDamping;
