within Effects;
model Backlash "Play in an elastic coupling: a spring that does not act around the middle"
  //   tau = -c max(-b, min(b, phi_rel - phi_0))
  // It takes away the torque of a spring with stiffness c within the play 2 b, and the constant c b beyond: together
  // they are a spring that begins where the play ends. Where c is smaller than the stiffness of the spring, that is only
  // softer within the play.
  extends PartialTwist;
  parameter Units.RotationalStiffness c     = 0   "Stiffness that is missing within the play";
  parameter Units.Angle               b     = 0.1 "Half the play";
  parameter Units.Angle               phi_0 = 0   "Twist in the middle of the play";
equation
  tau = -c*noEvent(max(-b, min(b, phi_rel - phi_0)));

  annotation(__mocc(
    effect   = "amplitude=c>0; b=0.02*span(phi_rel),0.05*span(phi_rel),0.15*span(phi_rel); phi_0=0",
    law      = "tau = -c max(-b, min(b, phi_rel - phi_0))",
    explains = "%at has play."));
end Backlash;
