//! Algebraic loops that are left to the integrator: against closed forms, published values, and the
//! reduced mode.

use mocc::ir::program::SystemForm;
use mocc::simulate::settings::Method;

use super::door::{Case, Reading, assert_close};

/// Cells of `C u' = w - u + s(t)` whose `w` are coupled by `u - w = g(w - left) + g(w - right)`
/// with `g(x) = x + x^3`, and sources by which `w[i] = a[i] exp(-t)`: then
/// `u[i] = A[i] exp(-t) + B[i] exp(-3 t)` with sums `A` and `B` of the differences of `a`.
const LADDER: &str = "model Ladder
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
end Ladder;";

/// A large loop: 80 unknowns, whose matrix is sparse.
#[test]
fn a_ladder_in_closed_form() {
    for method in [Method::Auto, Method::Radau, Method::Bdf] {
        let case = Case::text(LADDER).form(SystemForm::Dae).stop(2.0).tolerance(1e-7);
        let mut compiled = case.compile();
        assert_eq!(compiled.program.algebraics.len(), 80);
        assert_eq!(compiled.program.order(), 160);
        compiled.method(method);
        let run = compiled.run();
        for i in [1, 2, 40, 79, 80] {
            let (w, a) = (run.of(&format!("w[{i}]")), f64::from(i).sin());
            for (t, w) in run.time.iter().zip(w) {
                let exact = a * (-t).exp();
                assert!(
                    (w - exact).abs() < 1e-6,
                    "{method:?}: w[{i}] at {t} s is {w}, not {exact}"
                );
            }
        }
    }
}

/// The transistor amplifier of the Bari/CWI test set for initial value problems, built of components:
/// its end values, as published there.
#[test]
fn the_transistor_amplifier_as_published() {
    let text = "model Amplifier
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
    end Amplifier;";
    let published = [
        -0.5562145012262709e-2,
        0.3006522471903042e1,
        0.2849958788608128e1,
        0.2926422536206241e1,
        0.2704617865010554e1,
        0.2761837778393145e1,
        0.4770927631616772e1,
        0.1236995868091548e1,
    ];
    for (method, tolerance) in [(Method::Radau, 1e-6), (Method::Bdf, 1e-5)] {
        let case = Case::text(text).form(SystemForm::Dae).stop(0.2).tolerance(1e-8);
        let mut compiled = case.compile();
        assert!(!compiled.program.algebraics.is_empty());
        compiled.method(method);
        let run = compiled.run();
        for (k, published) in published.iter().enumerate() {
            assert_close(run.last(&format!("y[{}]", k + 1)), *published, tolerance);
        }
    }
}

/// A loop with a relation of one of its unknowns, and a `reinit`: `z + z^3 = (if z > 1 then 4 else 3) x`
/// and `x' = -z`, set back to 2 when it falls below one half. Both modes see the same events.
#[test]
fn events_as_in_the_reduced_mode() {
    let text = "model Relaxing
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
    end Relaxing;";
    let case = || Case::text(text).stop(5.0).tolerance(1e-9);
    let (reduced, implicit) = (case().run(), case().form(SystemForm::Dae).run());
    assert_eq!(implicit.last("count"), reduced.last("count"));
    assert!(implicit.last("count") >= 2.0);
    assert_eq!(implicit.events.len(), reduced.events.len());
    for (a, b) in implicit.events.iter().zip(&reduced.events) {
        assert_eq!(a.what, b.what);
        assert!((a.time - b.time).abs() < 1e-7, "{} and {}", a.time, b.time);
    }
    for column in ["x", "z"] {
        for (row, t) in implicit.time.iter().enumerate() {
            // The loop itself holds in every row, to the tolerance of the run.
            let (x, z) = (implicit.of("x")[row], implicit.of("z")[row]);
            let gap = z + z.powi(3) - implicit.of("gain")[row] * x - 0.1 * z.sin();
            assert!(gap.abs() < 1e-6, "at {t} s the loop is off by {gap}");
        }
        assert!((implicit.last(column) - reduced.last(column)).abs() < 1e-6);
    }
}

/// What the mode leaves alone: loops of parameters, and loops that rest between events.
#[test]
fn a_loop_that_rests_is_solved_inside() {
    let text = "model Resting
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
    end Resting;";
    let compiled = Case::text(text).form(SystemForm::Dae).stop(1.0).tolerance(1e-8).compile();
    assert!(compiled.program.algebraics.is_empty());
    // z = 1 first, then 2: z + z^3 = 10.
    assert_close(compiled.run().last("x"), (-0.5_f64 - 1.0).exp(), 1e-7);
}
