within Translational;
model Inertia "Mass that follows a given motion, without a state of its own"
  //   f = m d2s/dt2
  // For bodies whose motion is given (MovedSpool) or belongs to another mass.
  parameter Units.Mass m "Mass";

  Units.Velocity     v "Speed";
  Units.Acceleration a "Acceleration";

  Flange flange;
equation
  v = der(flange.s);
  a = der(v);
  flange.f = m*a;
end Inertia;
