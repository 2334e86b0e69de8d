// status: 1
// error[MO0401] lib/Translational/Flange.mo:3:18
// error[MO0402] lib/Translational/Flange.mo:4:20
model Drive
  Translational.Mass   mass(m = 1);
  Translational.Spring spring(c = 100);
  Translational.Damper damper(d = 2);
equation
  connect(spring.flange_b, mass.flange);
end Drive;
