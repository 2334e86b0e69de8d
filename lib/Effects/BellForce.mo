within Effects;
model BellForce "Force around one position"
  //   f = F exp(-((s - s_0)/w)^2)
  // An edge, a burr or a groove. The shape is that of the push-in force of the spool valve paper.
  // Source: "Component-based Modular System Modelling of a Spool Valve", section 4.2.
  extends PartialForce;
  parameter Units.Force    F   = 0      "Peak of the force, positive towards +s";
  parameter Units.Position s_0 = 0      "Position of the peak";
  parameter Units.Length   w   = 0.2e-3 "Width: distance at which 37 % of it acts";
equation
  f = F*exp(-((s - s_0)/w)^2);

  annotation(__mocc(
    effect   = "amplitude=F; s_0=s(15); w=0.03*span(s),0.06*span(s),0.12*span(s)",
    law      = "f = F exp(-((s - s_0)/w)^2)",
    explains = "A force that depends on position alone acts on %at."));
end BellForce;
