within Translational;
model Force "Given force on a flange"
  input Units.Force f "Force, positive towards +s";
  Flange flange;
equation
  flange.f = -f;
end Force;
