//@ case deduced_ranges
// Iterators without a range run over the dimension that they index.
model Deduced
  type Gear = enumeration(First, Second, Third);
  parameter Real a[3] = {1, 2, 4};
  Real b[3];
  Real c[2, 3];
  Real d[Gear];
  Real e[Boolean];
  Real s = sum(a[i]*b[i] for i);
  Real f[3] = {a[i]^2 for i};
  Real g;
equation
  for i loop
    b[i] = 10*a[i];
  end for;
  for i, j loop
    c[i, j] = 10*i + j;
  end for;
  for i loop
    d[i] = if i == Gear.Third then 30 else Integer(i);
  end for;
  for i loop
    e[i] = if i then 1 else 2;
  end for;
algorithm
  g := 0;
  for i loop
    g := g + a[i];
  end for;
end Deduced;
//@ expect s, g = 10*(1 + 4 + 16), 7
//@ expect b[3], f[3], c[2,3] = 40, 16, 23
//@ expect d[2], d[3] = 2, 30
//@ expect e[1], e[2] = 2, 1

//@ case ranges_that_change
// Comprehensions, reductions and loops may run over values that change; subscripts are known at compile time.
model Over
  record Tank Real level; end Tank;
  parameter Integer chosen[:] = {3, 1};
  Integer k = if time > 0.5 then 1 else 2;
  Real v[3] = {time, 2*time, 3};
  Tank low(level = time), high(level = 2);
  Real squares = sum(e^2 for e in v);
  Real most = max(e for e in v[1:2]);
  Real levels[:] = {t.level for t in {low, high}};
  Real some[:] = {v[i] for i in chosen};
  Real now[:] = {v[i] for i in {k, 3}};
  Real table[2, 2] = {x*y for x in {1.5, 2.5}, y in v[2:3]};
  Boolean large[3] = {x > 1.5 for x in v};
  Real total;
algorithm
  total := 0;
  for e in v loop
    total := total + e;
  end for;
end Over;
//@ expect squares, most, total = 14, 2, 6
//@ expect levels[1:2] = 1, 2
//@ expect some[1:2] = 3, 1
//@ expect now[1:2] = 1, 3
//@ expect large[1:3] = 0, 1, 1
//@ expect table[1,1:2], table[2,1:2] = 3, 5, 4.5, 7.5

//@ case sum_of_arrays
//@ run stop=1
// The sum of an expression that is an array has its sizes, which may be zero (section 10.3.4.1).
model Sums
  parameter Integer n = 3;
  parameter Integer none = 0;
  Real x[n, 2] = {{k*time, k*k} for k in 1:n};
  Real y[2] = sum(x[k, :] for k in 1:n);
  Real z[2, 2] = sum(a*{{1, 0}, {0, b}} for a in 1:2, b in 1:3);
  Real empty[none];
  Real total = sum(empty) + y[1];
equation
  empty = sum(fill(time, none) for k in 1:n);
end Sums;
//@ expect y[1], y[2] = 6, 14
//@ expect z[1,1], z[1,2], z[2,1], z[2,2] = 9, 0, 0, 18
//@ expect total = 6

//@ case reductions_whose_number_of_terms_varies
//@ run stop=4
package Means
  function mean "of the first k"
    input Real x[:];
    input Integer k;
    output Real y;
  algorithm
    y := if k == 0 then 0 else sum(x[i] for i in 1:k)/k;
  end mean;
  model Recorder
    Integer k(start = 0, fixed = true);
    parameter Real x[5] = {2, 4, 9, 1, 7};
    Real m = mean(x, k);
    Real products = product(x[i] for i in 1:k);
    Real most = max(x[i] for i in 1:k);
    Real pairs = sum(x[i]*j for i in 1:k, j in 1:2);
    Real none = sum(x[i] for i in 2:k - 10);
  equation
    when sample(0.5, 1) then
      k = pre(k) + 1;
    end when;
  end Recorder;
end Means;
//@ expect m at 0, 1, 3, 4 = 0, 2, 5, 4 rel 1e-12
//@ expect products at 0, 3 = 1, 72
//@ expect most at 2, 4 = 4, 9
//@ expect pairs at 3 = 45
//@ expect none = 0
