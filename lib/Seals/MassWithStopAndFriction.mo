within Seals;
model MassWithStopAndFriction "Rigid body between two stops, with its friction: the simplest spool"
  // Section 4.1 of the spool valve paper: one friction law for everything that rubs.
  extends Translational.StopMass;
  replaceable model FrictionLaw = Friction.Frictionless constrainedby Friction.Law "How it rubs";
  SpoolFriction friction(redeclare model FrictionLaw = FrictionLaw) "All that rubs";
equation
  connect(friction.spool, seals);
end MassWithStopAndFriction;
