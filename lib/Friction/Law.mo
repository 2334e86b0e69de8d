within Friction;
partial model Law "Interface of all friction laws: what rubs, and how much can be held at rest"
  // A law of dry friction answers with two magnitudes, f_slide and f_static. Whether the spool slides, and which way,
  // is known to the spool alone (Translational.StopMass), so a law needs no case distinction for v = 0. A law of
  // bristles or of smoothed friction answers with one force that has its own sign, f_signed, and that acts at rest as
  // well; its magnitudes are 0, and so a spool that only such laws rub is never locked but by its stops. `v` has its
  // sign for laws with a memory of the path.
  input Units.Velocity           v    "Speed of the spool";
  input Units.PressureDifference dp   "Pressure difference across the seal, not negative";
  input Units.Time               t_no "Time without operation";
  input Boolean                  closed = true "True while the seal touches the housing";

  Units.Velocity speed = noEvent(abs(v)) "Magnitude of v";
  Units.Force f_slide      "Friction magnitude while sliding";
  Units.Force f_static     "Friction that can be mobilised at rest";
  Units.Force f_signed = 0 "Friction that acts always, positive against +v";
end Law;
