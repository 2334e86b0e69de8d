within Translational;
model Spring "Linear spring with preload"
  //   f = f_0 + c (s_rel - s_rel0)
  parameter Units.SpringStiffness c       "Stiffness";
  parameter Units.Length          s_rel0 = 0 "Length at which the tension is the preload";
  parameter Units.Force           f_0    = 0 "Preload: tension at the length s_rel0";

  Units.Length s_rel "Length: flange_b.s - flange_a.s";
  Units.Force  f     "Tension, positive when the spring draws its ends together";

  Flange flange_a;
  Flange flange_b;
equation
  s_rel = flange_b.s - flange_a.s;
  f = f_0 + c*(s_rel - s_rel0);
  flange_b.f = f;
  flange_a.f = -f;
end Spring;
