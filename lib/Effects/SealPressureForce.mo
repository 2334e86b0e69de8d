within Effects;
model SealPressureForce "Pressure difference of a seal acting on a ring of the spool"
  // f = A (p_a - p_b): the two sides of a seal do not balance, for their diameters differ.
  extends PartialSealForce;
  parameter Units.EffectiveArea A = 0 "Area, positive if p_a pushes towards +s";
equation
  f = A*dp;

  annotation(__mocc(
    effect   = "amplitude=A; host=spool,port_a,port_b",
    explains = "The pressure difference at %at pushes the spool."));
end SealPressureForce;
