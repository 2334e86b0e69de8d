within Effects;
model BearingStribeck "Dry friction of a bearing that is greater at low speed"
  //   tau = -(M + M_s exp(-(w/w_s)^2)) z
  // Stribeck's curve without its viscous part: M + M_s where the shaft begins to turn, M at high speed. The elastic
  // beginning over a small angle (PartialDryFriction) holds a stuck shaft.
  // Source: Armstrong-Hélouvry, Dupont and Canudas de Wit (1994), "A survey of models, analysis tools and compensation
  // methods for the control of machines with friction", Automatica 30(7).
  extends PartialDryFriction;
  parameter Units.Torque          M   = 0 "Friction torque at high speed";
  parameter Units.Torque          M_s = 0 "Excess at rest";
  parameter Units.AngularVelocity w_s = 1 "Speed at which 37 % of the excess is left";
equation
  tau = -(M + M_s*exp(-(w/w_s)^2))*z;

  annotation(__mocc(
    effect   = "amplitude=M>0,M_s>0; delta=1e-5*span(phi); w_s=0.02*span(w),0.05*span(w),0.15*span(w); simpler=Effects.BearingFriction",
    law      = "tau = -(M + M_s exp(-(w/w_s)^2)) z",
    explains = "Dry friction brakes %at, more at low speed than at high speed."));
end BearingStribeck;
