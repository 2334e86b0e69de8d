model Bounds
  Real x = time;
  Real late = delay(x, 2, 1);
  Real free = delay(x, 0.5, x);
  Integer n = cardinality(x);
end Bounds;
