//@ case transistor_amplifier
//@ used by implicit.rs
// The transistor amplifier of the Bari/CWI test set for initial value problems.
model Amplifier
  constant Real pi = 3.141592653589793;
  parameter Real ub = 6, uf = 0.026, alpha = 0.99, beta = 1e-6, r0 = 1000, r = 9000;
  Real ue = 0.1 * sin(200 * pi * time);
  Real c1(start = -3, fixed = true), c2(start = 3, fixed = true), c3(start = 3, fixed = true);
  Real c4(start = 3, fixed = true), c5(start = 6, fixed = true);
  Real y[8](start = {0, 3, 3, 6, 3, 3, 6, 0});
  Real i1, i3, i5, f1, f2;
equation
  c1 = y[1] - y[2];
  c2 = y[3];
  c3 = y[4] - y[5];
  c4 = y[6];
  c5 = y[7] - y[8];
  f1 = beta * (exp((y[2] - y[3]) / uf) - 1);
  f2 = beta * (exp((y[5] - y[6]) / uf) - 1);
  1e-6 * der(c1) = i1;
  2e-6 * der(c2) = f1 - y[3] / r;
  3e-6 * der(c3) = i3;
  4e-6 * der(c4) = f2 - y[6] / r;
  5e-6 * der(c5) = i5;
  (ue - y[1]) / r0 = i1;
  i1 = y[2] / r - (ub - y[2]) / r + (1 - alpha) * f1;
  (ub - y[4]) / r = alpha * f1 + i3;
  i3 = y[5] / r - (ub - y[5]) / r + (1 - alpha) * f2;
  (ub - y[7]) / r = alpha * f2 + i5;
  i5 = y[8] / r;
end Amplifier;

//@ case events_in_a_loop
//@ used by implicit.rs
model Relaxing
  Real x(start = 2, fixed = true);
  Real z(start = 1.5);
  Real gain = if z > 1 then 4 else 3;
  Integer count(start = 0, fixed = true);
equation
  z + z ^ 3 = gain * x + 0.1 * sin(z);
  der(x) = -z;
  when x < 0.5 then
    reinit(x, 2);
    count = pre(count) + 1;
  end when;
end Relaxing;

//@ case loop_at_rest
//@ used by implicit.rs
model Resting
  parameter Real p = 2;
  Real x(start = 1, fixed = true);
  Real z(start = 1);
  discrete Real u(start = 1, fixed = true);
equation
  z + z ^ 3 = p * u;
  der(x) = -z * x;
  when time > 0.5 then
    u = 5;
  end when;
end Resting;

//@ case ladder
//@ used by implicit.rs
// Cells of `C u' = w - u + s(t)` whose `w` are coupled by `u - w = g(w - left) + g(w - right)`
// with `g(x) = x + x^3`, and sources by which `w[i] = a[i] exp(-t)`: then
// `u[i] = A[i] exp(-t) + B[i] exp(-3 t)` with sums `A` and `B` of the differences of `a`.
model Ladder
  parameter Integer N = 80;
  final parameter Real a[N + 2] = {sin(i) for i in 0:N + 1};
  Real u[N](start = {A(a[i], a[i + 1], a[i + 2]) + B(a[i], a[i + 1], a[i + 2]) for i in 1:N},
    each fixed = true);
  Real w[N](start = {a[i + 1] for i in 1:N});
  Real end0 = a[1] * exp(-time);
  Real endN = a[N + 2] * exp(-time);
  function g
    input Real x;
    output Real y = x + x ^ 3;
  end g;
  function A
    input Real left, own, right;
    output Real y = own + (own - left) + (own - right);
  end A;
  function B
    input Real left, own, right;
    output Real y = (own - left) ^ 3 + (own - right) ^ 3;
  end B;
equation
  for i in 1:N loop
    u[i] - w[i] = g(w[i] - (if i == 1 then end0 else w[i - 1]))
      + g(w[i] - (if i == N then endN else w[i + 1]));
    der(u[i]) = w[i] - u[i]
      - a[i + 1] * exp(-time) - 2 * B(a[i], a[i + 1], a[i + 2]) * exp(-3 * time);
  end for;
end Ladder;
