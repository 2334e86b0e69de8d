// status: 1
// error[MO0230] 7:3
model Mixed
  Translational.Mass mass(m = 1);
  Pneumatics.Volume  tank(V_0 = 1);
equation
  connect(mass.flange, tank.port);
end Mixed;
