within Seals;
model SpoolFriction "The friction of a whole spool in one place: no seal, no edge, no pressure"
  replaceable model FrictionLaw = Friction.Frictionless constrainedby Friction.Law "How it rubs";
  FrictionLaw friction(v = spool.v, dp = 0, t_no = spool.t_no);

  Translational.SpoolFlange spool "The spool";
equation
  spool.f_slide = -friction.f_slide;
  spool.f_static = -friction.f_static;
  spool.f_push = friction.f_signed;
end SpoolFriction;
