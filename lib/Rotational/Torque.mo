within Rotational;
model Torque "Torque on a flange, given by an input"
  input Units.Torque tau "Torque, positive towards +phi";
  Flange flange;
equation
  flange.tau = -tau;
end Torque;
