within Effects;
model AddedMass "Additional mass that moves along"
  //   f = -m dv/dt
  // A part heavier than specified, or air and grease that move along.
  extends PartialDrag;
  parameter Units.Mass m = 0 "Additional mass";

  Units.Acceleration a "Acceleration";
equation
  a = der(v);
  f = -m*a;

  annotation(__mocc(
    effect   = "amplitude=m>0",
    law      = "f = -m dv/dt",
    explains = "%at carries additional mass."));
end AddedMass;
