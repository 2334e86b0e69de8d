within Effects;
model BellForce "Force around one position"
  // f = F exp(-((s - s_0)/w)^2): an edge, a burr, a groove, as the push-in force of the spool valve paper (section
  // 4.2).
  extends PartialForce;
  parameter Units.Force    F   = 0      "Peak of the force, positive towards +s";
  parameter Units.Position s_0 = 0      "Position of the peak";
  parameter Units.Length   w   = 0.2e-3 "Width: distance at which 37 % of it act";
equation
  f = F*exp(-((s - s_0)/w)^2);

  annotation(__mocc(
    effect   = "amplitude=F; s_0=s(15); w=0.1e-3,0.2e-3,0.4e-3",
    explains = "A force that depends on position alone acts on %at."));
end BellForce;
