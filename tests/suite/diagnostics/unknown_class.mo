// status: 1
// error[MO0201] 4:17
model Shaft
  Translational.Sprnig spring(c = 100);
end Shaft;
