within Translational;
model Damper "Linear damper"
  //   f = d ds_rel/dt
  parameter Units.DampingCoefficient d "Damping coefficient";

  Units.Length   s_rel "Length: flange_b.s - flange_a.s";
  Units.Velocity v_rel "Speed of lengthening";
  Units.Force    f     "Tension";

  Flange flange_a;
  Flange flange_b;
equation
  s_rel = flange_b.s - flange_a.s;
  v_rel = der(s_rel);
  f = d*v_rel;
  flange_b.f = f;
  flange_a.f = -f;
end Damper;
