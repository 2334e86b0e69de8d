within Effects;
partial model PartialForce "Force on a flange"
  Units.Position s "Position";
  Units.Force    f "The force on what is connected, positive towards +s";

  Translational.Flange flange "Where it acts";
equation
  s = flange.s;
  flange.f = -f;
end PartialForce;
