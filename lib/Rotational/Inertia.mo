within Rotational;
model Inertia "Rigid body that turns without friction"
  //   J d2phi/dt2 = tau
  parameter Units.MomentOfInertia J             "Moment of inertia";
  parameter Units.Angle           phi_start = 0 "Angle at the start";
  parameter Units.AngularVelocity w_start   = 0 "Speed at the start";

  Units.Angle               phi(start = phi_start, fixed = true, stateSelect = StateSelect.prefer) "Angle";
  Units.AngularVelocity     w(start = w_start, fixed = true, stateSelect = StateSelect.prefer)     "Speed";
  Units.AngularAcceleration a                                                                      "Acceleration";

  Flange flange;
equation
  phi = flange.phi;
  w = der(phi);
  a = der(w);
  J*a = flange.tau;
end Inertia;
