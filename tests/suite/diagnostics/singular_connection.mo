// status: 1
// error[MO0402] lib/Pneumatics/Source.mo:20:5
// error[MO0401] lib/Pneumatics/Port.mo:4:27
model Supplies
  Pneumatics.Source left(p = 2e5);
  Pneumatics.Source right(p = 3e5);
equation
  connect(left.port, right.port);
end Supplies;
