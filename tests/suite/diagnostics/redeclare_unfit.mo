// status: 1
// error[MO0203] lib/Seals/PartialSeal.mo:9:37
// error[MO0203] lib/Seals/PartialSeal.mo:9:46
// error[MO0202] lib/Seals/PartialSeal.mo:33:44
// error[MO0202] lib/Seals/PartialSeal.mo:34:45
// FIXME: should be refused at the redeclaration: Translational.Mass does not fit `constrainedby Friction.Law`.
model Slider
  Seals.SingleSeal seal(contact = Seals.Contact.CloseOnly, redeclare model FrictionLaw = Translational.Mass(m = 1));
end Slider;
