within Effects;
partial model PartialDryFriction "Torque on a shaft that reverses with the direction, and holds at rest"
  //   delta dz/dt = w - |w| z
  // z is the share of the friction that acts. It reverses within the angle delta and keeps its value at rest, so a
  // stuck shaft stays where it is; delta is small compared with the angles of the record.
  // Source: Dahl (1968), "A solid friction model", Aerospace Corporation TOR-0158(3107-18)-1, with exponent 1.
  extends PartialBearing;
  parameter Units.Angle delta = 1e-3 "Angle after which 63 % of the friction has reversed";

  Units.AngularVelocity speed = noEvent(abs(w))    "Magnitude of w";
  Units.Fraction        z(start = 0, fixed = true) "Share of the friction that acts, -1 to 1";
equation
  delta*der(z) = w - speed*z;
end PartialDryFriction;
