within Seals;
model SpoolFriction "Friction of a whole spool in one place: no seals, no edges, no pressure"
  replaceable model FrictionLaw = Friction.Frictionless constrainedby Friction.Law "Friction law";
  FrictionLaw friction(v = spool.v, dp = 0, t_no = spool.t_no);

  Translational.SpoolFlange spool "The spool";
equation
  spool.f_slide = -friction.f_slide;
  spool.f_static = -friction.f_static;
  spool.f_push = friction.f_signed;
end SpoolFriction;
