// status: 1
// error[MO0225] 5:76
// Translational.Mass does not fit `constrainedby Friction.Law`.
model Slider
  Seals.SingleSeal seal(contact = Seals.Contact.CloseOnly, redeclare model FrictionLaw = Translational.Mass(m = 1));
end Slider;
