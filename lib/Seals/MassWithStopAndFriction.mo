within Seals;
model MassWithStopAndFriction "Rigid body between two stops, with its friction: the simplest spool"
  // Section 4.1 of the spool valve paper: one friction law for everything that rubs.
  parameter Units.Mass     m              "Mass";
  parameter Units.Position s_min      = 0 "Lower stop";
  parameter Units.Position s_max          "Upper stop";
  parameter Units.Position s_start    = s_min "Position at the start";
  parameter Units.Velocity v_start    = 0     "Speed at the start, 0 if it rests";
  parameter Translational.Motion mode_start = Translational.Motion.AtMin "What it is doing before the start";
  parameter Units.Time     t_no_start = 0     "Time without operation before the start";

  replaceable model FrictionLaw = Friction.Frictionless constrainedby Friction.Law "How it rubs";

  Units.Position s = body.s "Stroke";
  Units.Velocity v = body.v "Speed";
  Units.Force    f_static = body.f_static "Friction available at rest";

  Translational.StopMass body(m = m, s_min = s_min, s_max = s_max, s_start = s_start, v_start = v_start,
    mode_start = mode_start, t_no_start = t_no_start);
  SpoolFriction rubbing(redeclare model FrictionLaw = FrictionLaw) "All that rubs";

  Translational.Flange flange "Forces that drive the body";
equation
  connect(body.flange, flange);
  connect(rubbing.spool, body.seals);
end MassWithStopAndFriction;
