//@ case depth_from_a_parameter
// 1, 1/2, ... 1/64 are not below the least: a full tree of seven levels.
model Halves
  function parts
    input Real x;
    input Real least;
    output Integer n = 0;
  algorithm
    if x >= least then
      n := parts(x/2, least) + parts(x/2, least) + 1;
    end if;
  end parts;
  parameter Real least = 0.01;
  final parameter Integer n = parts(1, least);
  Real y = n*time;
end Halves;
//@ expect y = 127 rel 1e-12

//@ case depth_known_at_run_time
//@ run model=P.Numbers stop=2 also=flat
// Depths that are known at run time: by `if` expressions, by `return`, through another function, and in an
// argument of the function itself.
package P
  function fibonacci
    input Integer n;
    output Integer f;
  algorithm
    f := if n < 2 then n else fibonacci(n - 1) + fibonacci(n - 2);
  end fibonacci;
  function power
    input Real x;
    input Integer n;
    output Real y;
  algorithm
    if n <= 0 then
      y := 1;
      return;
    end if;
    y := byHalves(x, n);
  end power;
  function byHalves
    input Real x;
    input Integer n;
    output Real y;
  protected
    Real h;
  algorithm
    h := power(x, div(n, 2));
    y := if mod(n, 2) == 0 then h*h else x*h*h;
  end byHalves;
  function ackermann
    input Integer m;
    input Integer n;
    output Integer a;
  algorithm
    if m == 0 then
      a := n + 1;
    elseif n == 0 then
      a := ackermann(m - 1, 1);
    else
      a := ackermann(m - 1, ackermann(m, n - 1));
    end if;
  end ackermann;
  function isEven
    input Integer n;
    output Boolean is;
  algorithm
    is := n == 0 or isOdd(n - 1);
  end isEven;
  function isOdd
    input Integer n;
    output Boolean is;
  algorithm
    is := n <> 0 and isEven(n - 1);
  end isOdd;
  model Numbers
    Integer n = integer(5*time);
    Integer f = fibonacci(n);
    Real p = power(1 + time, n);
    Integer a = ackermann(2, n);
    Boolean even = isEven(n);
    // Deeper than calls are taken apart, though all is known.
    Integer whole = countUp(0, 5000);
  end Numbers;
  function countUp
    input Integer from;
    input Integer to;
    output Integer n;
  algorithm
    n := if from == to then from else countUp(from + 1, to);
  end countUp;
end P;
//@ let fibonacci(n) = if n < 2 then n else fibonacci(n - 1) + fibonacci(n - 2)
//@ expect f = 55
//@ expect each f = fibonacci(n)
//@ expect each p = (1 + time)^n rel 1e-12
// The values for m = 2.
//@ expect each a = 2*n + 3
//@ expect each even = mod(n, 2) == 0
//@ expect each whole = 5000

//@ case adaptive_integral
//@ run model=P.Decay stop=3 tolerance=1e-8
//@ used by sensitivity.rs
//@ used by machine_code.rs
// Simpson's rule by halves, of a function with an argument given: as fine as it must be, which depends on
// that argument.
package P
  partial function Integrand
    input Real u;
    output Real y;
  end Integrand;
  function byHalves
    input Integrand f;
    input Real a;
    input Real b;
    input Real f_a;
    input Real f_m;
    input Real f_b;
    input Real tolerance;
    output Real integral;
    output Integer calls;
  protected
    Real m = (a + b)/2;
    Real f_l = f((a + m)/2);
    Real f_r = f((m + b)/2);
    Real once = (b - a)/6*(f_a + 4*f_m + f_b);
    Real twice = (b - a)/12*(f_a + 4*f_l + 2*f_m + 4*f_r + f_b);
    Real right;
    Integer more;
  algorithm
    if abs(twice - once) <= 15*tolerance then
      integral := twice + (twice - once)/15;
      calls := 1;
    else
      (integral, calls) := byHalves(f, a, m, f_a, f_l, f_m, tolerance/2);
      (right, more) := byHalves(f, m, b, f_m, f_r, f_b, tolerance/2);
      integral := integral + right;
      calls := calls + more + 1;
    end if;
  end byHalves;
  function integral
    input Integrand f;
    input Real a;
    input Real b;
    input Real tolerance = 1e-10;
    output Real integral = byHalves(f, a, b, f(a), f((a + b)/2), f(b), tolerance);
  end integral;
  function decay
    extends Integrand;
    input Real k;
  algorithm
    y := k*exp(-k*u);
  end decay;
  model Decay
    parameter Real k = 1;
    Real x(start = 1, fixed = true);
    Real y = integral(function decay(k = k + time), 0, 2);
  equation
    der(x) = -integral(function decay(k = k), 0, 2)*x;
  end Decay;
end P;
//@ expect each y = 1 - exp(-2*(1 + time)) rel 1e-9
//@ expect each x = exp(-(1 - exp(-2))*time) rel 1e-6

//@ case records_arrays_and_loops
//@ run stop=3 interval=0.125 tolerance=1e-8
model Trees
  record Tree
    Real leaf;
    Real branches[2];
  end Tree;
  function sum
    input Tree tree;
    input Integer depth;
    input Real factor = 0.5;
    output Real total;
    output Tree pruned;
  protected
    Real part;
  algorithm
    total := tree.leaf;
    pruned := tree;
    if depth > 0 then
      for i in 1:2 loop
        part := sum(Tree(factor*tree.branches[i], {tree.leaf, tree.branches[i]}), depth - 1, factor);
        total := total + part;
      end for;
      pruned := Tree(total, {0, 0});
    end if;
  end sum;
  function permutations
    input Real x;
    input Integer n;
    output Real y;
  algorithm
    y := x;
    // The number of calls is known only at run time, at each level.
    for i in 1:n loop
      y := y + permutations(x/n, n - 1);
    end for;
  end permutations;
  function place
    input Real nodes[:];
    input Real x;
    input Integer low = 1;
    input Integer high = size(nodes, 1);
    output Integer k;
  protected
    Integer middle = div(low + high, 2);
  algorithm
    k := if high - low <= 1 then low
      elseif x < nodes[middle] then place(nodes, x, low, middle)
      else place(nodes, x, middle, high);
  end place;
  parameter Real nodes[9] = {0, 1, 2, 3, 4, 5, 7, 8, 9};
  Integer depth = integer(time);
  Real total;
  Tree pruned;
  Real y(start = 1, fixed = true);
  Real steps;
equation
  (total, pruned) = sum(Tree(time, {1, 2}), depth);
  der(y) = -permutations(y, depth);
  steps = noEvent(place(nodes, 3*time));
end Trees;
//@ let tree(leaf, first, second, depth) = if depth == 0 then leaf \
//@   else leaf + tree(0.5*first, leaf, first, depth - 1) + tree(0.5*second, leaf, second, depth - 1)
//@ expect each total = tree(time, 1, 2, depth) rel 1e-12
//@ expect each pruned.leaf = if depth > 0 then tree(time, 1, 2, depth) else time rel 1e-12
// The number of the last node at or below 3 t, of those that leave one above.
//@ let below(x) = 1 + sum(if k <= x then 1 else 0 for k in 1:5) + (if 7 <= x then 1 else 0) + (if 8 <= x then 1 else 0)
//@ expect each steps = below(3*time)
// Each call gives its argument as often as it calls itself, and once more: n + 1 times.
//@ let rate(t) = min(t, 1) + 2*min(max(t - 1, 0), 1) + 3*max(t - 2, 0)
//@ expect y at 0.5, 1, 1.5, 2, 2.5, 3 = exp(-rate(time)) rel 1e-6

//@ case one_in_another
//@ run stop=2 interval=0.125
model Nested
  function rise
    input Real x;
    input Real step;
    input Integer n;
    output Real y;
  algorithm
    y := if x > n then x else rise(x + step, step, n + 0);
  end rise;
  function climb
    input Real x;
    input Integer n;
    input Integer size;
    output Real y;
  protected
    Real steps[size] = {rise(x, 0.5 + k, n) for k in 1:size};
  algorithm
    y := if x > 5 then x else climb(sum(steps)/size, n + 1, size);
  end climb;
  Integer n = integer(2*time);
  Real y = noEvent(climb(time, n, 3));
end Nested;
//@ let rise(x, step, n) = if x > n then x else rise(x + step, step, n)
//@ let climb(x, n) = if x > 5 then x else climb(sum(rise(x, 0.5 + k, n) for k in 1:3)/3, n + 1)
//@ expect each y = climb(time, n) rel 1e-12

//@ case mutual
//@ run stop=3 interval=0.125
// Each calls the other and itself, so that one is read while the other is.
model Each
  function first
    input Integer n;
    input Real x;
    input Integer depth = 1;
    output Real y;
  algorithm
    y := if n <= 0 then x else first(n - 1, x + depth, 1) + second(n - 2, x, depth + 1);
  end first;
  function second
    input Integer n;
    input Real x;
    input Integer depth;
    output Real y;
  algorithm
    y := if n <= 0 then -x else second(n - 1, x, depth)*0.5 + first(n - 3, 2*x, depth + 2);
  end second;
  Integer n = integer(3*time);
  Real y = first(n, time);
end Each;
//@ let first(n, x, depth) = if n <= 0 then x else first(n - 1, x + depth, 1) + second(n - 2, x, depth + 1)
//@ let second(n, x, depth) = if n <= 0 then -x else second(n - 1, x, depth)*0.5 + first(n - 3, 2*x, depth + 2)
//@ expect each y = first(n, time, 1) rel 1e-12
