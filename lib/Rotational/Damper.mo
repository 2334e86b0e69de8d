within Rotational;
model Damper "Linear rotational damper"
  //   tau = d dphi_rel/dt
  parameter Units.RotationalDamping d "Damping coefficient";

  Units.Angle           phi_rel "Angle of twist: flange_b.phi - flange_a.phi";
  Units.AngularVelocity w_rel   "Difference of the speeds";
  Units.Torque          tau     "Torque that slows the difference down";

  Flange flange_a;
  Flange flange_b;
equation
  phi_rel = flange_b.phi - flange_a.phi;
  w_rel = der(phi_rel);
  tau = d*w_rel;
  flange_b.tau = tau;
  flange_a.tau = -tau;
end Damper;
