within Effects;
partial model PartialTwist "Torque between two shafts, in addition to existing ones"
  Units.Angle  phi_rel "Angle of twist: flange_b.phi - flange_a.phi";
  Units.Torque tau     "Torque that turns the ends back";

  Rotational.Flange flange_a;
  Rotational.Flange flange_b;
equation
  phi_rel = flange_b.phi - flange_a.phi;
  flange_b.tau = tau;
  flange_a.tau = -tau;
end PartialTwist;
