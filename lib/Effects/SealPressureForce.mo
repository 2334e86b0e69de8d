within Effects;
model SealPressureForce "Pressure difference across a seal, acting on the spool"
  //   f = A (p_a - p_b)
  // The two sides of the seal have different diameters.
  extends PartialSealForce;
  parameter Units.EffectiveArea A = 0 "Area, positive if p_a pushes towards +s";
equation
  f = A*dp;

  annotation(__mocc(
    effect   = "amplitude=A; host=spool,port_a,port_b",
    law      = "f = A (p_a - p_b)",
    explains = "The pressure difference at %at pushes the spool."));
end SealPressureForce;
