within Effects;
model InductorSaturation "Inductor whose iron saturates"
  //   i = a psi^3,   dpsi/dt = v
  // The current that an inductor draws beyond psi/L: its inductance falls to L/(1 + 3 a L psi^2). psi is the flux
  // linkage, 0 at the start.
  extends PartialBranch;
  parameter Units.CubicReluctance a = 0 "Current per cube of the flux linkage";

  Units.FluxLinkage psi(start = 0, fixed = true) "Flux linkage";
equation
  der(psi) = v;
  i = a*psi^3;

  annotation(__mocc(
    effect   = "series=true; amplitude=a>0",
    law      = "i = a psi^3",
    explains = "The iron of %at saturates."));
end InductorSaturation;
