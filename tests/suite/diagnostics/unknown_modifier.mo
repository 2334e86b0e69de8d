// status: 1
// error[MO0203] 4:27
model Shaft
  Translational.Mass mass(mass = 1);
end Shaft;
