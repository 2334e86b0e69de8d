within Effects;
partial block PartialActuator "Between what a recording says of an input and what the system receives"
  input Real  u "Recorded value, in any unit";
  output Real y "Value that acts, in the same unit";
end PartialActuator;
