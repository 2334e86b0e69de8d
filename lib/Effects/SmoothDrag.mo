within Effects;
model SmoothDrag "Dry friction that vanishes at rest"
  //   f = -F tanh(v/v_0)
  // Coulomb's law with its jump rounded off: a body under load creeps instead of holding. It describes lubricated
  // contacts near rest, and models that smooth dry friction for the sake of the solver. The power -F v tanh(v/v_0) is
  // never positive.
  // Source: Andersson, Söderberg and Björklund (2007), "Friction models for sliding dry, boundary and mixed lubricated
  // contacts", Tribology International 40(4).
  extends PartialDrag;
  parameter Units.Force    F   = 0    "Friction at high speed";
  parameter Units.Velocity v_0 = 0.01 "Speed at which 76 % of it acts";
equation
  f = -F*tanh(v/v_0);

  annotation(__mocc(
    effect   = "amplitude=F>0; v_0=0.002*span(v),0.02*span(v),0.1*span(v)",
    law      = "f = -F tanh(v/v_0)",
    explains = "Dry friction that vanishes at rest brakes %at."));
end SmoothDrag;
