within Translational;
partial model PartialActuator "Anything that drives a flange: what can be exchanged for one another"
  Flange flange "What it drives";
end PartialActuator;
