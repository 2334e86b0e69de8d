//! Functions that round what runs with time (Modelica 3.6, section 3.7.2) have the values of their closed
//! forms at all times, whichever way their argument runs and wherever its offset comes from.

use super::door::{Case, Reading};

/// A function of the language and its closed form.
type Rounding = (&'static str, fn(f64) -> f64);

const FUNCTIONS: [Rounding; 8] = [
    ("floor(a)", f64::floor),
    ("ceil(a)", f64::ceil),
    ("integer(a)", f64::floor),
    ("div(a, 1)", f64::trunc),
    ("mod(a, 1)", |a| a - a.floor()),
    ("mod(a, -0.75)", |a| a + 0.75 * (a / -0.75).floor()),
    ("rem(a, 1)", |a| a - a.trunc()),
    ("div(a, 0.75)", |a| (a / 0.75).trunc()),
];

/// The offset of the argument: how it is written, what it needs, and its value.
type Offset = (&'static str, &'static str, fn(f64) -> f64);

const OFFSETS: [Offset; 5] = [
    ("0", "", |_| 0.0),
    ("0.37", "", |_| 0.37),
    ("p", "parameter Real p = -100.3;", |_| -100.3),
    ("c", "input Real c = 0.3;", |_| 0.3),
    (
        "c",
        "discrete Real c(start = 2.2, fixed = true); equation when time > 1.03 then c = -0.6; end when;",
        |t| if t > 1.03 { -0.6 } else { 2.2 },
    ),
];

/// Distance of an argument from a jump of its function below which either side is right.
const NEAR: f64 = 1e-6;

#[test]
fn rounded_times_have_their_closed_forms() {
    let mut wrong = Vec::new();
    for (call, closed) in FUNCTIONS {
        for slope in [-3, -2, -1, 1, 2, 3] {
            for (offset, declaration, value) in OFFSETS {
                let argument = format!("({offset} + ({slope})*time)");
                let rounded = call.replace("(a", &format!("({argument}"));
                let model = format!("model M\n Real y = {rounded};\n {declaration}\nend M;\n");
                let run = Case::text(&model).stop(2.2).interval(0.05).run();
                for (t, y) in run.time.iter().zip(run.of("y")) {
                    let a = value(*t) + f64::from(slope) * t;
                    let around = [closed(a - NEAR), closed(a + NEAR)];
                    if (t - 1.03).abs() < 1e-9 {
                        continue;
                    }
                    let near_jump = (around[0] - around[1]).abs() > 0.1;
                    if !near_jump && (y - closed(a)).abs() > 1e-9 {
                        wrong.push(format!("{y} instead of {} at {t}:\n{model}", closed(a)));
                        break;
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} are wrong\n{}", wrong.len(), wrong.join("\n"));
}

/// The integral of `ceil(time)` up to 2.2 is 1 + 2 + 3*0.2.
#[test]
fn a_rounded_time_drives_an_equation() {
    let model = "model M Real x(start = 0, fixed = true); equation der(x) = ceil(time); end M;";
    let run = Case::text(model).stop(2.2).run();
    super::door::assert_close(run.last("x"), 3.6, 1e-9);
}
