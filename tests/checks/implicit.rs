//! Algebraic loops that are left to the integrator: against closed forms, published values, and the
//! reduced mode.

use mocc::ir::program::SystemForm;
use mocc::simulate::settings::Method;

use super::door::{Case, Reading, assert_close, suite_model};

/// A large loop: 80 unknowns, whose matrix is sparse.
#[test]
fn a_ladder_in_closed_form() {
    for method in [Method::Auto, Method::Radau, Method::Bdf] {
        let case =
            Case::suite("simulate/implicit/ladder").form(SystemForm::Dae).stop(2.0).tolerance(1e-7);
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
    let text = &suite_model("simulate/implicit/transistor_amplifier");
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
    let text = &suite_model("simulate/implicit/events_in_a_loop");
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
    let text = &suite_model("simulate/implicit/loop_at_rest");
    let compiled = Case::text(text).form(SystemForm::Dae).stop(1.0).tolerance(1e-8).compile();
    assert!(compiled.program.algebraics.is_empty());
    // z = 1 first, then 2: z + z^3 = 10.
    assert_close(compiled.run().last("x"), (-0.5_f64 - 1.0).exp(), 1e-7);
}
