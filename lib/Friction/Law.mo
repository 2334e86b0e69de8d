within Friction;
partial model Law "Interface of all friction laws: what rubs, and how much can be held at rest"
  // A law answers with two magnitudes. Whether the spool slides, and which way, is known to the spool alone
  // (Translational.StopMass), so a law needs no case distinction for v = 0.
  // `v` has its sign for laws with a memory of the path.
  input Units.Velocity           v    "Speed of the spool";
  input Units.PressureDifference dp   "Pressure difference across the seal, not negative";
  input Units.Time               t_no "Time without operation";

  Units.Velocity speed "Magnitude of v";
  Units.Force f_slide  "Friction magnitude while sliding";
  Units.Force f_static "Friction that can be mobilised at rest";
equation
  speed = noEvent(abs(v));
end Law;
