within Translational;
partial model PartialActuator "Interface of components that drive a flange"
  Flange flange "The driven flange";
end PartialActuator;
