within Rotational;
model Spring "Linear torsion spring, or an elastic shaft"
  //   tau = c (phi_rel - phi_rel0)
  parameter Units.RotationalStiffness c            "Stiffness";
  parameter Units.Angle               phi_rel0 = 0 "Angle of twist without torque";

  Units.Angle  phi_rel "Angle of twist: flange_b.phi - flange_a.phi";
  Units.Torque tau     "Torque that turns the ends back";

  Flange flange_a;
  Flange flange_b;
equation
  phi_rel = flange_b.phi - flange_a.phi;
  tau = c*(phi_rel - phi_rel0);
  flange_b.tau = tau;
  flange_a.tau = -tau;
end Spring;
