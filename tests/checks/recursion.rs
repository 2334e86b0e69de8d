//! Functions that call themselves as deep as only a run knows.

use super::door::{Case, Reading, assert_close};

/// Depths that a run decides: by `if` expressions, by `return`, through another function, and in an
/// argument of itself.
const NUMBERS: &str = "package P
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
end P;";

#[test]
fn a_run_decides_how_deep_calls_go() {
    let case = Case::text(NUMBERS).model("P.Numbers").stop(2.0);
    let flat = case.flat();
    for run in [case.run(), Case::text(&flat).stop(2.0).run()] {
        let fibonacci = [0, 1, 1, 2, 3, 5, 8, 13, 21, 34, 55];
        assert_eq!(run.last("f"), 55.0);
        for (row, t) in run.time.iter().enumerate() {
            let n = run.of("n")[row];
            assert_eq!(run.of("f")[row], f64::from(fibonacci[n as usize]));
            assert_close(run.of("p")[row], (1.0 + t).powi(n as i32), 1e-12);
            // Its values for m = 2.
            assert_eq!(run.of("a")[row], 2.0 * n + 3.0);
            assert_eq!(run.of("even")[row], f64::from(u8::from(n % 2.0 == 0.0)));
            assert_eq!(run.of("whole")[row], 5000.0);
        }
    }
}

/// Simpson's rule by halves, of a function with an argument given: as fine as it must be, which depends on
/// that argument.
pub const INTEGRAL: &str = "package P
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
end P;";

#[test]
fn an_integral_is_as_fine_as_it_must_be() {
    let case = Case::text(INTEGRAL).model("P.Decay").stop(3.0).tolerance(1e-8);
    let run = case.compile().differentiate(&["k"]);
    let trajectory = &run.trajectory;
    let rate = 1.0 - (-2.0f64).exp();
    for (row, t) in trajectory.time.iter().enumerate() {
        let k = 1.0 + t;
        assert_close(trajectory.of("y")[row], 1.0 - (-2.0 * k).exp(), 1e-9);
        assert_close(trajectory.of("x")[row], (-rate * t).exp(), 1e-6);
        // The rule is differentiated with the steps that it takes.
        assert!((run.by(0, "y")[row] - 2.0 * (-2.0 * k).exp()).abs() < 1e-7);
        let slope = -2.0 * (-2.0f64).exp() * t * (-rate * t).exp();
        assert!((run.by(0, "x")[row] - slope).abs() < 1e-6);
    }
}

#[test]
fn calls_stand_in_loops_and_carry_records_and_arrays() {
    let run = Case::text(
        "model Trees
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
             // As many calls as only a run knows, of as many.
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
         end Trees;",
    )
    .stop(3.0)
    .interval(0.125)
    .tolerance(1e-8)
    .run();
    fn sum(leaf: f64, branches: [f64; 2], depth: i32) -> f64 {
        match depth {
            0 => leaf,
            _ => leaf + branches.iter().map(|b| sum(0.5 * b, [leaf, *b], depth - 1)).sum::<f64>(),
        }
    }
    let nodes = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 7.0, 8.0, 9.0];
    for (row, t) in run.time.iter().enumerate() {
        let depth = run.of("depth")[row];
        let total = sum(*t, [1.0, 2.0], depth as i32);
        assert_close(run.of("total")[row], total, 1e-12);
        let leaf = if depth > 0.0 { total } else { *t };
        assert_close(run.of("pruned.leaf")[row], leaf, 1e-12);
        let place = nodes[1..8].iter().filter(|x| **x <= 3.0 * t).count() + 1;
        assert_eq!(run.of("steps")[row], place as f64);
    }
    // Each call gives its argument as often as it calls itself, and once more: n + 1 times.
    let rate = |t: f64| t.min(1.0) + 2.0 * (t - 1.0).clamp(0.0, 1.0) + 3.0 * (t - 2.0).max(0.0);
    for t in [0.5, 1.0, 1.5, 2.0, 2.5, 3.0] {
        assert_close(run.at("y", t), (-rate(t)).exp(), 1e-6);
    }
}

#[test]
fn one_recursion_stands_in_another() {
    let run = Case::text(
        "model Nested
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
         end Nested;",
    )
    .stop(2.0)
    .interval(0.125)
    .run();
    fn rise(x: f64, step: f64, n: f64) -> f64 {
        if x > n { x } else { rise(x + step, step, n) }
    }
    fn climb(x: f64, n: f64) -> f64 {
        let mean = (1..=3).map(|k| rise(x, 0.5 + f64::from(k), n)).sum::<f64>() / 3.0;
        if x > 5.0 { x } else { climb(mean, n + 1.0) }
    }
    for (row, t) in run.time.iter().enumerate() {
        assert_close(run.of("y")[row], climb(*t, run.of("n")[row]), 1e-12);
    }
}

/// Each calls the other and itself, so that one is read while the other is.
#[test]
fn recursions_call_each_other() {
    let run = Case::text(
        "model Each
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
         end Each;",
    )
    .stop(3.0)
    .interval(0.125)
    .run();
    fn first(n: f64, x: f64, depth: f64) -> f64 {
        if n <= 0.0 { x } else { first(n - 1.0, x + depth, 1.0) + second(n - 2.0, x, depth + 1.0) }
    }
    fn second(n: f64, x: f64, depth: f64) -> f64 {
        if n <= 0.0 {
            -x
        } else {
            second(n - 1.0, x, depth) * 0.5 + first(n - 3.0, 2.0 * x, depth + 2.0)
        }
    }
    for (row, t) in run.time.iter().enumerate() {
        assert_close(run.of("y")[row], first(run.of("n")[row], *t, 1.0), 1e-12);
    }
}
