within Effects;
partial model PartialStretch "Force between two bodies, in addition to existing ones"
  Units.Length s_rel "Distance: flange_b.s - flange_a.s";
  Units.Force  f     "Force that pulls the ends together";

  Translational.Flange flange_a;
  Translational.Flange flange_b;
equation
  s_rel = flange_b.s - flange_a.s;
  flange_b.f = f;
  flange_a.f = -f;
end PartialStretch;
