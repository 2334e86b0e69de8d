within Effects;
model Backlash "Play in an elastic coupling: a spring and a damper that do not act around the middle"
  //   tau = -c max(-b, min(b, x)) - d w_rel for |x| < b, with x = phi_rel - phi_0 and w_rel = dphi_rel/dt
  // It takes away the torques of a spring with stiffness c and of a damper with d within the play 2 b, and the constant
  // c b beyond: together they are a coupling that begins to act where the play ends. Where c and d are smaller than those
  // of the coupling, that is only softer within the play. The damper sets in over the last tenth of the play.
  extends PartialTwist;
  parameter Units.RotationalStiffness c     = 0   "Stiffness that is missing within the play";
  parameter Units.RotationalDamping   d     = 0   "Damping that is missing within the play";
  parameter Units.Angle               b     = 0.1 "Half the play";
  parameter Units.Angle               phi_0 = 0   "Twist in the middle of the play";

  Units.AngularVelocity w_rel "Difference of the speeds";
protected
  Real loose(unit = "1") "Share of the damper that is missing";
equation
  w_rel = der(phi_rel);
  loose = noEvent(max(0, min(1, 10*(1 - abs(phi_rel - phi_0)/b))));
  tau = -c*noEvent(max(-b, min(b, phi_rel - phi_0))) - d*loose*w_rel;

  annotation(__mocc(
    effect   = "series=true; amplitude=c>0,d>0; b=0.02*span(phi_rel),0.05*span(phi_rel),0.15*span(phi_rel); phi_0=0",
    law      = "tau = -c max(-b, min(b, phi_rel - phi_0)) - d w_rel within the play",
    explains = "%at has play."));
end Backlash;
