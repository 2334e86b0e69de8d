//! Consistent initial values: what decides between solutions, and how the iteration gets there.

use super::door::{Case, Reading, assert_close};

/// Newton's iteration for `x^3 - 2 x + 2 = 0` is caught near 0.8 from the right, where the left side
/// has its least value; the only root is far to the left. The simplified equation leads there.
const FAR: &str = "model Far
      Real x(start = 1);
    equation
      0 = ACTUAL;
    end Far;";

/// The real root of `x^3 - 2 x + 2` by Cardano's formula.
fn root() -> f64 {
    let discriminant = (1.0f64 - 8.0 / 27.0).sqrt();
    -((1.0 + discriminant).cbrt() + (1.0 - discriminant).cbrt())
}

#[test]
fn homotopy_leads_to_a_solution_that_the_iteration_does_not_find() {
    let text = FAR.replace("ACTUAL", "homotopy(actual = x^3 - 2*x + 2, simplified = x + 2)");
    let run = Case::text(&text).stop(0.1).run();
    assert_close(run.first("x"), root(), 1e-12);
    assert_close(run.last("x"), root(), 1e-12);
}

/// Without it a change of sign is looked for at last, outwards from the guess.
#[test]
fn without_it_the_start_is_searched() {
    let run = Case::text(&FAR.replace("ACTUAL", "x^3 - 2*x + 2")).stop(0.1).run();
    assert_close(run.first("x"), root(), 1e-12);
}

#[test]
#[should_panic(expected = "MO0904")]
fn what_has_no_solution_has_no_start() {
    Case::text(&FAR.replace("ACTUAL", "x^4 - 2*x + 2")).stop(0.1).run();
}

/// Where the guess serves, the simplified equation is not looked at: it has no solution here.
#[test]
fn homotopy_means_the_actual_equation() {
    let text = "model Direct
      Real x(start = 1);
    equation
      0 = homotopy(actual = x^2 - 2, simplified = x^2 + 1);
    end Direct;";
    assert_close(Case::text(text).stop(0.1).run().first("x"), 2f64.sqrt(), 1e-14);
}

#[test]
fn the_start_decides_between_two_solutions() {
    for (start, exact) in [("0.5", 2.0), ("-0.5", -2.0)] {
        let text = format!(
            "model Two
               Real x(start = {start});
             equation
               x^2 = 4;
             end Two;"
        );
        assert_close(Case::text(&text).stop(0.1).run().first("x"), exact, 1e-14);
    }
}

#[test]
fn bounds_keep_the_iteration_where_the_solution_makes_sense() {
    for (bounds, exact) in [("min = 0.1", 2.0), ("max = -0.1", -2.0)] {
        for start in ["1", "-1"] {
            let text = format!(
                "model Bounded
                   Real x(start = {start}, {bounds});
                 equation
                   x^2 = 4;
                 end Bounded;"
            );
            assert_close(Case::text(&text).stop(0.1).run().first("x"), exact, 1e-14);
        }
    }
}

/// `min` and `max` do not make a solution beyond them impossible.
#[test]
fn a_solution_beyond_the_bounds_is_found() {
    let text = "model Beyond
      Real x(start = 1, max = 1.5);
    equation
      x^3 = 8;
    end Beyond;";
    assert_close(Case::text(text).stop(0.1).run().first("x"), 2.0, 1e-14);
}

/// A parameter that the initial equations determine.
#[test]
fn a_free_parameter_is_determined_by_an_initial_equation() {
    let text = "model Tuned
      parameter Real k(fixed = false, start = 1);
      Real x(start = 1, fixed = true);
    initial equation
      der(x) = -3;
    equation
      der(x) = -k ^ 2 * x;
    end Tuned;";
    let run = Case::text(text).stop(1.0).tolerance(1e-9).run();
    assert_close(run.last("x"), (-3.0f64).exp(), 1e-7);
}

#[test]
fn values_beyond_their_bounds_are_warned_of_once() {
    let text = "model Tank
           type Level = Real(min = 0);
           parameter Real area(min = 0.1, max = 10) = 1;
           parameter Real outlet(max = area) = 2*area;
           Level h(start = 1, fixed = true);
           Real empty(max = 0.5) = 1 - h;
           Real depth(min = -0.75, max = 1) = -h;
           Real other(min = -1) = sin(10*time);
         equation
           area*der(h) = -0.4;
         end Tank;";
    let said = |case: Case| -> Vec<String> {
        let warnings = case.compile().run_with_warnings().1;
        assert!(warnings.iter().all(|w| w.code == "MO0919"));
        warnings.into_iter().map(|w| w.message).collect()
    };
    let late = Case::text(text).stop(3.0).interval(0.5);
    let late = said(late);
    let wanted = [
        "parameter `outlet` is 2, above its `max` of 1",
        "at time 0 s `depth` is -1, below its `min` of -0.75",
        "at time 1.5 s `empty` is 0.6",
    ];
    assert_eq!(late.len(), wanted.len(), "{late:?}");
    assert!(late.iter().zip(wanted).all(|(found, begin)| found.starts_with(begin)), "{late:?}");
    let wide = Case::text(text).stop(3.0).interval(0.5).set("area=20").set("outlet=1");
    assert_eq!(said(wide)[0], "parameter `area` is 20, above its `max` of 10");
}
