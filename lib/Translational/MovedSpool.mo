within Translational;
model MovedSpool "Rubbed body that is moved along a given stroke: tells the force that takes"
  // The other way round than StopMass: the stroke is known, as a recording says it, and the force is asked for. What
  // friction does at rest does not follow from the stroke alone; it follows from the way: the share z of the friction
  // that acts turns within the way delta, delta dz/dt = v - |v| z (Dahl (1968), as Effects.DahlPresliding), and stays
  // where it is while the body rests. Noise of the stroke that is small beside delta turns nothing.
  //   f_drive = z f_slide - f,   f all forces on the body but friction and drive, those of inertia too (Effects.AddedMass).
  parameter Units.Length delta = 0.1e-3 "Way after which 63 % of the friction have turned";
  input Units.Position s "Stroke";

  Units.Velocity v       "Speed";
  Units.Fraction z(start = 0, fixed = true) "Share of the friction that acts, -1 to 1";
  Units.Force    f       "Force on the body but for friction and drive, positive towards +s";
  Units.Force    f_slide "Friction while sliding, sum over the seals";
  Units.Force    f_drive "Force of the drive, positive towards +s";

  Flange      flange "Forces on the body";
  SpoolFlange seals  "Seals that rub on it";
protected
  Units.Velocity speed "Magnitude of v";
equation
  v = der(s);
  speed = noEvent(abs(v));
  delta*der(z) = v - speed*z;
  f = flange.f + seals.f_push;
  f_slide = seals.f_slide;
  f_drive = z*f_slide - f;
  flange.s = s;
  seals.s = s;
  seals.v = v;
  seals.t_no = 0;
end MovedSpool;
