// status: 1
// error[MO0219] 7:27
// error[MO0219] 8:29
// error[MO0219] 9:27
model Bounds
  Real x = time;
  Real late = delay(x, 2, 1);
  Real free = delay(x, 0.5, x);
  Integer n = cardinality(x);
end Bounds;
