within Effects;
model AddedMass "Mass that moves along"
  // f = -m dv/dt: something heavier than the sheet says, or air and grease carried along.
  extends PartialDrag;
  parameter Units.Mass m = 0 "Additional mass";

  Units.Acceleration a "Acceleration";
equation
  a = der(v);
  f = -m*a;

  annotation(__mocc(
    effect   = "amplitude=m>0",
    explains = "%at carries additional mass."));
end AddedMass;
