within Seals;
model MassWithStopAndFriction "Rigid body between two stops with friction: the simplest spool"
  // One friction law for the whole spool.
  // Source: "Component-based Modular System Modelling of a Spool Valve", section 4.1.
  parameter Units.Mass     m              "Mass";
  parameter Units.Position s_min      = 0 "Lower stop";
  parameter Units.Position s_max          "Upper stop";
  parameter Units.Position s_start    = s_min "Position at the start";
  parameter Units.Velocity v_start    = 0     "Speed at the start, 0 if it rests";
  parameter Translational.Motion mode_start = Translational.Motion.AtMin "Motion before the start";
  parameter Units.Time     t_no_start = 0     "Time without operation before the start";

  replaceable model FrictionLaw = Friction.Frictionless constrainedby Friction.Law "Friction law";

  Units.Position s = body.s "Stroke";
  Units.Velocity v = body.v "Speed";
  Units.Force    f_static = body.f_static "Friction available at rest";

  Translational.StopMass body(m = m, s_min = s_min, s_max = s_max, s_start = s_start, v_start = v_start,
    mode_start = mode_start, t_no_start = t_no_start);
  SpoolFriction rubbing(redeclare model FrictionLaw = FrictionLaw) "Friction of the spool";

  Translational.Flange flange "Forces that drive the body";
equation
  connect(body.flange, flange);
  connect(rubbing.spool, body.seals);
end MassWithStopAndFriction;
