//@ case decay
//@ used by calibrate.rs
model Decay
  parameter Real k(unit = "1/s") = 1 "Rate";
  parameter Real unseen = 3;
  Real x(start = 1, fixed = true, unit = "m");
  Real z = unseen*time;
equation
  der(x) = -k*x;
end Decay;

//@ case decay_to_ambient
//@ used by calibrate.rs
model DecayToAmbient
  parameter Real k(unit = "1/s") = 1 "Rate";
  parameter Real ambient(unit = "m") = 0 "Value at rest";
  Real x(start = 1, fixed = true, unit = "m");
equation
  der(x) = -k*(x - ambient);
end DecayToAmbient;

//@ case tied_parts
//@ used by calibrate.rs
model Part
  parameter Real k = 1;
  Real x(start = 1, fixed = true);
equation
  der(x) = -k*x;
end Part;
model Two
  Part a, b[2];
  Real x(unit = "m") = a.x + 0.5*b[1].x + 0.5*b[2].x;
end Two;
