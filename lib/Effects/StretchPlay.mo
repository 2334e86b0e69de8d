within Effects;
model StretchPlay "Play in an elastic joint: a spring and a damper that do not act around the middle"
  //   f = -c max(-b, min(b, x)) - d v_rel for |x| < b, with x = s_rel - l_0
  // It takes away the forces of a spring with stiffness c and of a damper with d within the play 2 b, and the constant c b
  // beyond: together they are a joint that begins to act where the play ends. Where c and d are smaller than those of the
  // joint, that is only softer within the play. The damper sets in over the last tenth of the play.
  extends PartialStretchRate;
  parameter Units.SpringStiffness    c   = 0    "Stiffness that is missing within the play";
  parameter Units.DampingCoefficient d   = 0    "Damping that is missing within the play";
  parameter Units.Length             b   = 1e-3 "Half the play";
  parameter Units.Length             l_0 = 0    "Distance in the middle of the play";
protected
  Real loose(unit = "1") "Share of the damper that is missing";
equation
  loose = noEvent(max(0, min(1, 10*(1 - abs(s_rel - l_0)/b))));
  f = -c*noEvent(max(-b, min(b, s_rel - l_0))) - d*loose*v_rel;

  annotation(__mocc(
    effect   = "between=moving; series=true; amplitude=c>0,d>0; b=0.02*span(s_rel),0.05*span(s_rel),0.15*span(s_rel); l_0=0",
    law      = "f = -c max(-b, min(b, s_rel - l_0)) - d v_rel within the play",
    explains = "%at has play."));
end StretchPlay;
