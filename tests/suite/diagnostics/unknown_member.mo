// status: 1
// error[MO0202] 9:18
model Shaft
  Translational.Spring spring(c = 100);
  Translational.Fixed wall;
  Translational.Mass mass(m = 1);
equation
  connect(wall.flange, spring.flange_a);
  connect(spring.flangeb, mass.flange);
end Shaft;
