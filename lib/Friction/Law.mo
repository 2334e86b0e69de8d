within Friction;
partial model Law "Interface of all friction laws"
  // A law of dry friction computes two magnitudes, f_slide and f_static. Only the spool (Translational.StopMass)
  // knows whether it slides, and in which direction, so a law needs no case distinction for v = 0. Viscous friction,
  // and that of bristles, is one force with a sign, f_signed, which also acts at rest. A law without magnitudes holds
  // nothing: a spool with only such laws locks at its stops only. `v` has a sign for laws with a memory of the path.
  input Units.Velocity           v    "Speed of the spool";
  input Units.PressureDifference dp   "Pressure difference across the seal, not negative";
  input Units.Time               t_no "Time without operation";
  input Boolean                  closed = true "True while the seal touches the housing";

  Units.Velocity speed = noEvent(abs(v)) "Magnitude of v";
  Units.Force f_slide      "Dry friction while sliding, as a magnitude";
  Units.Force f_static     "Friction that can be mobilised at rest";
  Units.Force f_signed = 0 "Friction that acts always, positive against +v";
end Law;
