within Translational;
model MovedSpool "Body with friction that follows a given stroke; computes the force of the drive"
  //   f_drive = z f_slide - f,   delta dz/dt = v - |v| z
  // The inverse of StopMass: the stroke is known, for example from a recording, and the force is computed. The
  // friction at rest does not follow from the stroke alone but from the path: the fraction z of the friction that
  // acts reverses within the path delta (Dahl (1968), as in Effects.DahlPresliding) and stays constant while the body
  // rests. Noise of the stroke that is small compared with delta reverses nothing. f is the sum of all forces on the
  // body except friction and drive, including inertia (Effects.AddedMass).
  parameter Units.Length delta = 0.1e-3 "Path after which 63 % of the friction has reversed";
  input Units.Position s "Stroke";

  Units.Velocity v       "Speed";
  Units.Fraction z(start = 0, fixed = true) "Fraction of the friction that acts, -1 to 1";
  Units.Force    f       "Force on the body but for friction and drive, positive towards +s";
  Units.Force    f_slide "Friction while sliding, sum over the seals";
  Units.Force    f_drive "Force of the drive, positive towards +s";

  Flange      flange "Forces on the body";
  SpoolFlange seals  "Seals on the spool";
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
