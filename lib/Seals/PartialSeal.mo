within Seals;
partial model PartialSeal "Seal on a spool: friction while it is in contact, push-in force at its control edge"
  parameter Contact        contact     "Contact with the housing";
  parameter Units.Position s_ce    = 0 "Stroke at which it meets its control edge";
  parameter Units.Force    F_ce    = 0 "Push-in force: peak value at the edge";
  parameter Units.Length   w    = 1e-3 "Push-in force: width of its bell over the stroke";

  replaceable model FrictionLaw = Friction.Frictionless constrainedby Friction.Law "Friction law";
  FrictionLaw friction(v = spool.v, dp = dp, t_no = spool.t_no, closed = closed);

  Boolean                  closed "True while it touches the housing";
  Units.PressureDifference dp     "Pressure difference it separates, as a magnitude";
  Units.Force              f_push "Push-in force on the spool, positive towards +s";
  Units.Force              f_air = 0 "Force of the air on the spool, positive towards +s";

  Translational.SpoolFlange spool  "Where it sits";
  Pneumatics.Port           port_a "One side";
  Pneumatics.Port           port_b "Other side";
protected
  Units.Fraction bell "Profile of the push-in force over the stroke";
equation
  closed = if contact == Contact.OpenToClose then spool.s > s_ce
    elseif contact == Contact.CloseToOpen then spool.s < s_ce
    else contact == Contact.CloseOnly;
  dp = noEvent(abs(port_a.p - port_b.p));

  // The edge pushes the seal back out: against the motion that closes it.
  bell = exp(-((spool.s - s_ce)/w)^2);
  f_push = if contact == Contact.OpenToClose then -F_ce*bell
    elseif contact == Contact.CloseToOpen then F_ce*bell
    else 0;

  // With these signs the forces act on the spool.
  spool.f_slide = if closed then -friction.f_slide else 0;
  spool.f_static = if closed then -friction.f_static else 0;
  spool.f_push = (if closed then friction.f_signed else 0) - f_push - f_air;
end PartialSeal;
