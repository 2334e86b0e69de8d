//@ case loops_and_slices
//@ snapshot flat
// Loops, slices and element-wise modifications become scalars.
model Rod
  parameter Integer n = 3;
  parameter Real k[n] = {1, 2, 3};
  Real T[n](start = fill(20, n), each fixed = true);
  Real q[n - 1];
equation
  for i in 1:n - 1 loop
    q[i] = k[i]*(T[i] - T[i + 1]);
  end for;
  der(T[1]) = -q[1];
  der(T[2:n - 1]) = q[1:n - 2] - q[2:n - 1];
  der(T[n]) = q[n - 1];
end Rod;
//@ expect flat has 3 "der("
//@ expect flat has 3 "fixed = true"
