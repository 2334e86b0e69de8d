within Effects;
model SmoothBearingFriction "Dry friction of a bearing that vanishes at rest"
  //   tau = -M tanh(w/w_0)
  // Coulomb's law with its jump rounded off: a shaft under load creeps instead of holding. It describes lubricated
  // bearings near rest, and models that smooth dry friction for the sake of the solver. The power -M w tanh(w/w_0) is
  // never positive.
  // Source: Andersson, Söderberg and Björklund (2007), "Friction models for sliding dry, boundary and mixed lubricated
  // contacts", Tribology International 40(4).
  extends PartialBearing;
  parameter Units.Torque          M   = 0   "Friction torque at high speed";
  parameter Units.AngularVelocity w_0 = 0.1 "Speed at which 76 % of it acts";
equation
  tau = -M*tanh(w/w_0);

  annotation(__mocc(
    effect   = "amplitude=M>0; w_0=0.002*span(w),0.02*span(w),0.1*span(w)",
    law      = "tau = -M tanh(w/w_0)",
    explains = "Dry friction that vanishes at rest brakes %at."));
end SmoothBearingFriction;
