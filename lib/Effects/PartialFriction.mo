within Effects;
partial model PartialFriction "Coulomb friction on a spool, in addition to that of its seals"
  Units.Position s        "Stroke";
  Units.Velocity v        "Speed";
  Units.Velocity speed = noEvent(abs(v)) "Magnitude of v";
  Units.Force    f_slide  "Friction magnitude while sliding";
  Units.Force    f_static "Friction that can be mobilised at rest";

  Translational.SpoolFlange spool "The body with friction";
equation
  s = spool.s;
  v = spool.v;
  spool.f_slide = -f_slide;
  spool.f_static = -f_static;
  spool.f_push = 0;
end PartialFriction;
