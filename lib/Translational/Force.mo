within Translational;
model Force "Force on a flange, given by an input"
  input Units.Force f "Force, positive towards +s";
  Flange flange;
equation
  flange.f = -f;
end Force;
