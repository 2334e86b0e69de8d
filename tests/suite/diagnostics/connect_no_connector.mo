// status: 1
// error[MO0230] 7:11
model Mixed
  Translational.Mass  mass(m = 1);
  Translational.Fixed wall;
equation
  connect(mass, wall.flange);
end Mixed;
