within Effects;
partial model PartialTorque "Torque on a shaft"
  Units.Angle  phi "Angle";
  Units.Torque tau "The torque on what is connected, positive towards +phi";

  Rotational.Flange flange "Where it acts";
equation
  phi = flange.phi;
  flange.tau = -tau;
end PartialTorque;
