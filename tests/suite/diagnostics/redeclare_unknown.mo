// status: 1
// error[MO0203] 5:76
model Slider
  model Rubber = Friction.Coulomb(F_Coulomb = 1);
  Seals.SingleSeal seal(contact = Seals.Contact.CloseOnly, redeclare model FrictonLaw = Rubber);
end Slider;
