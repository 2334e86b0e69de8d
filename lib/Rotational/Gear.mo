within Rotational;
model Gear "Gear without losses, backlash or inertia"
  //   phi_a = ratio phi_b,   tau_b = -ratio tau_a
  parameter Real ratio = 1 "Speed of flange_a per speed of flange_b";
  Flange flange_a;
  Flange flange_b;
equation
  flange_a.phi = ratio*flange_b.phi;
  flange_b.tau = -ratio*flange_a.tau;
end Gear;
