within Effects;
partial block PartialSensor "Between what the model says of a signal and what its sensor reads"
  input Real  u "Simulated value, in any unit";
  output Real y "Reading, in the same unit";
end PartialSensor;
