//! `mocc calibrate`: estimates against closed forms, what it says to bad plans and data, and the
//! recordings of the test stand.

use std::fmt::Write;
use std::path::Path;

use mocc::io::csv::read_csv;
use serde_json::Value;

use super::door::{Reading, Scratch, assert_close, suite_model};
use super::program::{Ended, mocc};

/// Standard deviation of the noise of all recordings here, m.
const SIGMA: f64 = 0.01;
/// The 95 % quantile of chi-square with one degree of freedom.
const QUANTILE: f64 = 3.841_458_820_694_124;

fn decay_model() -> String {
    suite_model("calibrate/models/decay")
}

const PLAN: &str = r#"
model = "decay.mo"
[data]
folder = "."
table  = "table.csv"
file   = "file"
split  = "split"
[time]
column = "t"
unit   = "s"
[signals]
x_mm = { variable = "x", unit = "mm", sigma = 10 }
[free]
k          = {}
"start(x)" = {}
"#;

/// Normal random numbers: Marsaglia's polar method on a linear congruential generator.
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
    fn normal(&mut self) -> f64 {
        loop {
            let (u, v) = (2.0 * self.uniform() - 1.0, 2.0 * self.uniform() - 1.0);
            let s = u * u + v * v;
            if s > 0.0 && s < 1.0 {
                return u * (-2.0 * s.ln() / s).sqrt();
            }
        }
    }
}

/// Instants and noisy values of `2 exp(-1.5 t)`, m.
fn decay(seed: u64) -> Vec<(f64, f64)> {
    let mut noise = Noise(seed);
    let value = |i: i32| {
        let t = 0.01 * f64::from(i);
        (t, 2.0 * (-1.5 * t).exp() + SIGMA * noise.normal())
    };
    (0..=200).map(value).collect()
}

fn csv(rows: &[(f64, f64)]) -> String {
    let mut out = "t,x_mm\n".to_owned();
    rows.iter().for_each(|(t, x)| writeln!(out, "{t:.2},{:?}", 1e3 * x).expect("a string"));
    out
}

/// A folder with a model, a plan, and one recording for training and one for validation.
fn stand(model: &str, plan: &str) -> Scratch {
    let scratch = Scratch::new();
    scratch.file("decay.mo", model);
    scratch.file("plan.toml", plan);
    scratch.file("table.csv", "file,split\n1.csv,train\n2.csv,validation\n");
    scratch.file("1.csv", &csv(&decay(1)));
    scratch.file("2.csv", &csv(&decay(2)));
    scratch.file("empty.csv", "t,x_mm\n");
    scratch
}

fn calibrate(scratch: &Scratch) -> (Value, Ended) {
    let ended = mocc(scratch.path(), &["calibrate", "plan.toml", "--out", "out"]);
    assert_eq!(ended.status, 0, "{}", ended.err);
    (json(scratch.path(), "out"), ended)
}

fn json(folder: &Path, out: &str) -> Value {
    let text = std::fs::read_to_string(folder.join(out).join("calibration.json"));
    serde_json::from_str(&text.expect("a file")).expect("JSON")
}

fn number(value: &Value, path: &str) -> f64 {
    value.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path} in {value:#}"))
}

/// The same study in files and in memory: equal results, and residuals whose derivatives are those of the fit.
#[test]
fn a_front_end_may_hold_everything_in_memory() {
    use mocc::calibrate::memory::{Memory, NumberTable};
    use mocc::calibrate::policy::FitPolicy;
    use mocc::calibrate::run::{Request, calibrate, prepare, run};
    use mocc::driver::compile::Session;
    use mocc::io::csv::TextTable;

    let scratch = stand(&decay_model(), PLAN);
    let request = |plan: &str, memory: Memory| Request {
        plan: plan.into(),
        memory: memory.into(),
        data: None,
        modelica_path: None,
        profiles: false,
        policy: FitPolicy::default(),
    };
    let session = || Session { parameters_vary: true, ..Session::default() };
    let file = scratch.path().join("plan.toml").display().to_string();
    let of_files = run(&request(&file, Memory::default()), &mut session(), &()).expect("a fit");

    let names = |list: &[&str]| list.iter().map(|n| (*n).to_owned()).collect::<Vec<String>>();
    let frame = |seed| {
        // As the file has them.
        let time = |t: f64| format!("{t:.2}").parse::<f64>().expect("a number");
        let (t, x) = decay(seed).into_iter().map(|(t, x)| (time(t), 1e3 * x)).unzip();
        NumberTable { names: names(&["t", "x_mm"]), columns: vec![t, x] }
    };
    let rows = vec![(1, names(&["1.csv", "train"])), (2, names(&["2.csv", "validation"]))];
    let memory = Memory {
        plan: Some(PLAN.to_owned()),
        model: Some(decay_model()),
        table: Some(TextTable { names: names(&["file", "split"]), rows }),
        recordings: vec![("1.csv".to_owned(), frame(1)), ("2.csv".to_owned(), frame(2))],
        ..Memory::default()
    };
    let request = request("no/such/plan.toml", memory);
    let mut session = session();
    let prepared = prepare(&request, &mut session).expect("a study");
    let mut problem = prepared.problem(&session.sources, &mut session.problems).expect("a problem");
    let outcome = calibrate(&prepared, &mut problem, &request, &()).expect("a fit");
    assert_eq!(outcome.values, of_files.values);
    assert_eq!(outcome.covariance, of_files.covariance);

    let at = |values: &[f64]| problem.residual_vector(values).expect("residuals");
    let (residuals, jacobian) = (at(&outcome.values), problem.jacobian(&outcome.values).unwrap());
    assert_eq!((residuals.len(), jacobian.len()), (201, 2 * 201));
    for j in 0..2 {
        let moved = |h: f64| {
            let mut values = outcome.values.clone();
            values[j] += h;
            at(&values)
        };
        let (above, below) = (moved(1e-4), moved(-1e-4));
        for k in 0..201 {
            let slope = (above[k] - below[k]) / 2e-4;
            assert!((slope - jacobian[2 * k + j]).abs() < 1e-2, "{slope} {}", jacobian[2 * k + j]);
        }
    }
    // The covariance is the inverse of `J^T J`.
    let gram =
        |i: usize, j: usize| (0..201).map(|k| jacobian[2 * k + i] * jacobian[2 * k + j]).sum();
    let (a, b, d): (f64, f64, f64) = (gram(0, 0), gram(0, 1), gram(1, 1));
    let det = a * d - b * b;
    for (found, expected) in outcome.covariance.iter().zip([d / det, -b / det, -b / det, a / det]) {
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    }
}

/// The sum of squares of the decay with this rate and its best start; that start.
fn profile_of_decay(rows: &[(f64, f64)], k: f64) -> (f64, f64) {
    let (mut xe, mut ee) = (0.0, 0.0);
    for (t, x) in rows {
        let e = (-k * t).exp();
        (xe, ee) = (xe + x * e, ee + e * e);
    }
    let start = xe / ee;
    let squares = rows.iter().map(|(t, x)| ((x - start * (-k * t).exp()) / SIGMA).powi(2));
    (squares.sum(), start)
}

/// The zero of a function that rises or falls between two points.
fn bisect(f: impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    for _ in 0..200 {
        let middle = 0.5 * (a + b);
        if (f(middle) > 0.0) == (f(a) > 0.0) { a = middle } else { b = middle }
    }
    a
}

#[test]
fn rate_and_start_of_a_decay_have_the_errors_of_the_closed_form() {
    let scratch = stand(&decay_model(), PLAN);
    let (found, ended) = calibrate(&scratch);
    assert_eq!(ended.err, "", "nothing to say where the errors go");
    let (k, x0) = (number(&found, "/parameters/0/value"), number(&found, "/parameters/1/value"));
    let errors = [0, 1].map(|i| number(&found, &format!("/parameters/{i}/standard_error")));
    assert!((k - 1.5).abs() < 3.0 * errors[0] && (x0 - 2.0).abs() < 3.0 * errors[1], "{k} {x0}");

    // The minimum itself: the derivative of the profile is zero there.
    let rows = decay(1);
    let cost = |k: f64| profile_of_decay(&rows, k).0;
    let best = bisect(|k| cost(k + 1e-5) - cost(k - 1e-5), 1.3, 1.7);
    assert!((k - best).abs() < 2e-3 * errors[0], "{k} {best}");
    let chi = number(&found, "/quality/train/reduced_chi_square");
    assert_close(chi, cost(best) / 199.0, 1e-5);
    assert!((chi - 1.0).abs() < 0.3, "{chi}");
    assert!((number(&found, "/quality/validation/reduced_chi_square") - 1.0).abs() < 0.3);

    // The bound of Cramér and Rao: the inverse of the Fisher information.
    let (mut a, mut b, mut c) = (0.0, 0.0, 0.0);
    for (t, _) in &rows {
        let e = (-k * t).exp() / SIGMA;
        let (by_k, by_start) = (-x0 * t * e, e);
        (a, b, c) = (a + by_k * by_k, b + by_k * by_start, c + by_start * by_start);
    }
    let determinant = a * c - b * b;
    assert_close(errors[0], (c / determinant).sqrt(), 1e-4);
    assert_close(errors[1], (a / determinant).sqrt(), 1e-4);
    assert_close(number(&found, "/correlations/0/1"), -b / (a * c).sqrt(), 1e-4);

    // The profile: where its sum of squares has grown by the quantile.
    let ends = [(0, 1.0), (1, 2.0)].map(|(i, far)| {
        let expected = bisect(|k| cost(k) - cost(best) - QUANTILE, best, far);
        let end = number(&found, &format!("/parameters/0/interval_95/{i}"));
        assert!((end - expected).abs() < 0.01 * errors[0], "{end} {expected}");
        assert_eq!(found["parameters"][0]["interval_from"][i], "profile");
        end
    });
    assert_close(ends[1] - ends[0], 2.0 * 1.96 * errors[0], 0.02);
    assert_eq!((&found["complete"], &found["converged"]), (&true.into(), &true.into()));
}

#[test]
fn the_calibrated_model_runs_by_itself() {
    let scratch = stand(&decay_model(), PLAN);
    let (found, ended) = calibrate(&scratch);
    assert!(ended.out.contains("out/decay_calibrated.mol"), "{}", ended.out);
    let alone = Scratch::new();
    let text = std::fs::read_to_string(scratch.path().join("out/decay_calibrated.mol"));
    let text = text.expect("a model");
    assert!(text.starts_with(decay_model().trim_end()) && text.contains("// +- "), "{text}");
    alone.file("m.mol", &text);
    let run =
        mocc(alone.path(), &["simulate", "m.mol", "--output", "r.csv", "--tolerance", "1e-9"]);
    assert_eq!((run.status, run.err.as_str()), (0, ""));
    assert!(run.out.starts_with("Decay_calibrated"), "{}", run.out);
    let table = read_csv(alone.path().join("r.csv")).expect("a table");
    let [k, x0] = [0, 1].map(|i| number(&found, &format!("/parameters/{i}/value")));
    assert_close(table.first("x"), x0, 1e-12);
    assert_close(table.last("x"), x0 * (-k).exp(), 1e-7);
}

#[test]
fn tied_parameters_take_one_value() {
    let model = &suite_model("calibrate/models/tied_parts");
    let plan = PLAN.replace(
        "k          = {}\n\"start(x)\" = {}",
        "rate = { tied = [\"a.k\", \"b[1].k\", \"b[2].k\"], start = 1.2 }",
    );
    let scratch = stand(model, &plan);
    let (found, _) = calibrate(&scratch);
    let [k, error] =
        ["value", "standard_error"].map(|x| number(&found, &format!("/parameters/0/{x}")));
    assert!((k - 1.5).abs() < 3.0 * error, "{k}");
    let rows = decay(1);
    let fisher: f64 = rows.iter().map(|(t, _)| (2.0 * t * (-k * t).exp() / SIGMA).powi(2)).sum();
    assert_close(error, 1.0 / fisher.sqrt(), 1e-4);
    let run = mocc(scratch.path(), &["simulate", "out/decay_calibrated.mol", "--output", "r.csv"]);
    assert_eq!((run.status, run.err.as_str()), (0, ""));
    let table = read_csv(scratch.path().join("r.csv")).expect("a table");
    assert_close(table.last("x"), 2.0 * (-k).exp(), 1e-4);
    assert_close(table.last("b[2].x"), (-k).exp(), 1e-4);
}

/// Recordings of one decay from different starts to different values at rest: the rate is that of all, and
/// start and rest are those of each recording, fitted or not.
#[test]
fn each_recording_has_values_of_its_own() {
    let own = [(1, 2.0, 0.3), (2, 0.7, -0.2), (3, -1.5, 0.1), (4, 3.0, 0.5)];
    let plan = PLAN.replace(
        "\"start(x)\" = {}",
        "[free.each]\nambient = { min = -5, max = 5 }\n\"start(x)\" = { min = -5, max = 5 }",
    );
    let scratch = stand(&suite_model("calibrate/models/decay_to_ambient"), &plan);
    scratch
        .file("table.csv", "file,split\n1.csv,train\n2.csv,train\n3.csv,validation\n4.csv,test\n");
    let mut rows = Vec::new();
    for (k, start, rest) in own {
        let shifted = |(t, x): (f64, f64)| {
            let e = (-1.5 * t).exp();
            (t, x - 2.0 * e + rest + (start - rest) * e)
        };
        rows.push(decay(k).into_iter().map(shifted).collect::<Vec<_>>());
        scratch.file(&format!("{k}.csv"), &csv(&rows[k as usize - 1]));
    }
    let (found, ended) = calibrate(&scratch);
    let names: Vec<&str> = found["parameters"]
        .as_array()
        .expect("a list")
        .iter()
        .filter_map(|p| p["name"].as_str())
        .collect();
    assert_eq!(names, ["k"]);
    let [k, error] =
        ["value", "standard_error"].map(|x| number(&found, &format!("/parameters/0/{x}")));
    assert!((k - 1.5).abs() < 3.0 * error, "{k} +- {error}");
    for split in ["train", "validation", "test"] {
        let chi = number(&found, &format!("/quality/{split}/reduced_chi_square"));
        assert!((chi - 1.0).abs() < 0.3, "{split}: {chi}");
    }
    for (i, ((_, start, rest), rows)) in own.iter().zip(&rows).enumerate() {
        let of =
            |name: &str, what: &str| number(&found, &format!("/each/{i}/parameters/{name}/{what}"));
        let [x, error] = ["value", "standard_error"].map(|what| of("start(x)", what));
        assert!((x - start).abs() < 4.0 * error && error < 0.01, "{i}: {x} +- {error}");
        let [at_rest, error] = ["value", "standard_error"].map(|what| of("ambient", what));
        assert!((at_rest - rest).abs() < 4.0 * error && error < 0.01, "{i}: {at_rest} +- {error}");
        // With the rate frozen, start and rest of a recording are a linear problem.
        if i >= 2 {
            let (mut a, mut b, mut c, mut p, mut q) = (0.0, 0.0, 0.0, 0.0, 0.0);
            for (t, x) in rows {
                let e = (-k * t).exp();
                (a, b, c) = (a + e * e, b + e * (1.0 - e), c + (1.0 - e).powi(2));
                (p, q) = (p + x * e, q + x * (1.0 - e));
            }
            let determinant = a * c - b * b;
            assert!((x - (p * c - q * b) / determinant).abs() < 2e-5, "{x}");
            assert!((at_rest - (q * a - p * b) / determinant).abs() < 2e-5, "{at_rest}");
            assert_close(error, SIGMA * (a / determinant).sqrt(), 1e-3);
        }
    }
    let line = ended.out.lines().find(|l| l.starts_with("recording ")).unwrap_or_default();
    assert!(line.contains("ambient, m") && line.ends_with("start(x), m"), "{}", ended.out);
    let text = std::fs::read_to_string(scratch.path().join("out/decay_calibrated.mol"));
    let text = text.expect("a model");
    let (_, added) = text.split_once("_calibrated").expect("the calibrated model");
    assert!(added.contains("k = 1.") && !added.contains("ambient"), "{text}");
}

fn evaluate(scratch: &Scratch, arguments: &[&str]) -> (Value, Ended) {
    let arguments = [&["evaluate"], arguments, &["--json", "judged.json"]].concat();
    let ended = mocc(scratch.path(), &arguments);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""), "{}", ended.out);
    let text = std::fs::read_to_string(scratch.path().join("judged.json")).expect("a file");
    (serde_json::from_str(&text).expect("JSON"), ended)
}

/// The model keeps the values of its file: the error on each recording is that of the closed form.
#[test]
fn a_frozen_model_is_judged() {
    let scratch = stand(&decay_model(), PLAN);
    let expected = |rows: &[(f64, f64)], start: f64, k: f64| {
        let squares = rows.iter().map(|(t, x)| (x - start * (-k * t).exp()).powi(2));
        1e3 * (squares.sum::<f64>() / rows.len() as f64).sqrt()
    };
    let (found, _) = evaluate(&scratch, &["plan.toml"]);
    for i in 0..2 {
        let rmse = number(&found, &format!("/recordings/{i}/signals/x_mm/rmse"));
        assert_close(rmse, expected(&decay(i + 1), 1.0, 1.0), 1e-4);
        assert_eq!(found["recordings"][i as usize]["signals"]["x_mm"]["unit"], "mm");
    }

    // The calibrated model, on new recordings, named in both ways.
    calibrate(&scratch);
    scratch.file("new/table.csv", "file,split\n7.csv,test\n");
    scratch.file("new/7.csv", &csv(&decay(7)));
    let model = "out/decay_calibrated.mol";
    let (by_plan, ended) = evaluate(&scratch, &["plan.toml", "--model", model, "--data", "new"]);
    let (by_model, _) = evaluate(&scratch, &[model, "--plan", "plan.toml", "--data", "new"]);
    assert_eq!(by_plan, by_model);
    assert_eq!(by_plan["model"], "Decay_calibrated");
    assert!((number(&by_plan, "/reduced_chi_square") - 1.0).abs() < 0.3);
    let rmse = number(&by_plan, "/signals/x_mm/rmse");
    assert_close(rmse, expected(&decay(7), 2.0, 1.5), 0.02);
    let line = ended.out.lines().find(|l| l.starts_with("7.csv")).expect("a line");
    assert!(
        ended.out.starts_with("Decay_calibrated\n") && line.contains(" test "),
        "{}",
        ended.out
    );
}

/// What belongs to a recording is fitted to it, and nothing else is.
#[test]
fn a_frozen_model_has_the_values_of_each_recording() {
    let plan = PLAN.replace("\"start(x)\" = {}", "[free.each]\n\"start(x)\" = {}");
    let model = decay_model().replace("= 1 \"Rate\"", "= 1.5 \"Rate\"");
    let scratch = stand(&model, &plan);
    let (found, ended) = evaluate(&scratch, &["plan.toml"]);
    for i in 0..2 {
        let (_, start) = profile_of_decay(&decay(i + 1), 1.5);
        assert_close(number(&found, &format!("/each/{i}/parameters/start(x)/value")), start, 1e-5);
        let chi = number(&found, &format!("/recordings/{i}/reduced_chi_square"));
        assert!((chi - 1.0).abs() < 0.3, "{chi}");
    }
    assert!(ended.out.contains("start(x), m"), "{}", ended.out);
}

#[test]
fn an_evaluation_needs_one_plan_and_one_model() {
    let scratch = stand(&decay_model(), PLAN);
    let cases: [&[&str]; 4] = [
        &["decay.mo"],
        &["plan.toml", "--plan", "plan.toml"],
        &["decay.mo", "--plan", "plan.toml", "--model", "decay.mo"],
        &["plan.toml", "--model", "absent.mo"],
    ];
    let said = cases.map(|arguments| {
        let ended = mocc(scratch.path(), &[&["evaluate"], arguments].concat());
        assert_eq!((ended.status, ended.out.as_str()), (2, ""), "{arguments:?}");
        ended.err
    });
    insta::assert_snapshot!(said.join("\n"));
}

#[test]
fn undetermined_parameters_are_reported() {
    let scratch = stand(&decay_model(), &format!("{PLAN}unseen = {{ min = 1, max = 10 }}\n"));
    let (found, ended) = calibrate(&scratch);
    assert!(ended.out.contains("the data do not determine `unseen`"), "{}", ended.out);
    let unseen = &found["parameters"][2];
    assert_eq!((&unseen["determined"], &unseen["standard_error"]), (&false.into(), &Value::Null));
    assert_eq!(number(unseen, "/value"), 3.0);
    assert_eq!([number(unseen, "/interval_95/0"), number(unseen, "/interval_95/1")], [1.0, 10.0]);
    // The others are as sure as without it.
    let without = calibrate(&stand(&decay_model(), PLAN)).0;
    let error = "/parameters/0/standard_error";
    assert_close(number(&found, error), number(&without, error), 1e-9);
}

#[test]
fn two_parameters_of_one_effect_are_named_together() {
    let model = decay_model().replace("-k*x", "-k*unseen*x/3");
    let scratch = stand(&model, &format!("{PLAN}unseen = {{}}\n"));
    let (found, _) = calibrate(&scratch);
    assert_eq!(
        found["not_determined"],
        serde_json::json!([
            "the data determine only `k * unseen`, not `k` and `unseen` separately"
        ])
    );
}

#[test]
fn a_parameter_at_its_bound_says_so() {
    let plan = PLAN.replace("k          = {}", "k = { min = 0.5, max = 1.2 }");
    let (found, ended) = calibrate(&stand(&decay_model(), &plan));
    assert_eq!(number(&found, "/parameters/0/value"), 1.2);
    assert_eq!(found["parameters"][0]["at_bound"], true);
    assert!(ended.out.contains("at its bound"), "{}", ended.out);
}

/// Rows out of order, missing values and a gap are repaired and reported.
#[test]
fn recordings_are_repaired() {
    let scratch = stand(&decay_model(), PLAN);
    let mut rows = decay(1);
    rows.drain(100..140);
    let mut lines: Vec<String> = csv(&rows).lines().map(str::to_owned).collect();
    lines.swap(30, 31);
    lines[50] = "0.49,NaN".to_owned();
    lines[51] = "0.5,".to_owned();
    scratch.file("1.csv", &lines.join("\n"));
    let (found, ended) = calibrate(&scratch);
    insta::assert_snapshot!(
        found["repairs"].as_array().expect("a list").iter().filter_map(Value::as_str).collect::<Vec<_>>().join("\n"),
        @r"
        ./1.csv:32: 1 row skipped: the time does not increase
        ./1.csv:51: 2 values skipped: not a number
        ./1.csv: nothing was recorded for 4.100e-1 s
        "
    );
    assert!(ended.out.contains("repaired: "), "{}", ended.out);
    let [k, error] =
        ["value", "standard_error"].map(|x| number(&found, &format!("/parameters/0/{x}")));
    assert!((k - 1.5).abs() < 3.0 * error, "{k}");
    assert_eq!(found["quality"]["train"]["values"], 201 - 40 - 1 - 2);
}

/// The output for a plan or a recording in which `old` is replaced by `new`.
fn refused(file: &str, old: &str, new: &str) -> String {
    let scratch = stand(&decay_model(), PLAN);
    let path = scratch.path().join(file);
    let text = std::fs::read_to_string(&path).expect("a file");
    assert!(text.contains(old), "{file} has no {old}");
    scratch.file(file, &text.replace(old, new));
    let ended = mocc(scratch.path(), &["calibrate", "plan.toml", "--out", "out"]);
    let written = scratch.path().join("out/calibration.json").exists();
    assert!(ended.out.is_empty() && !written, "{}", ended.out);
    format!("status {}\n{}", ended.status, ended.err)
}

#[test]
fn bad_plans_and_recordings_are_refused_with_place_and_remedy() {
    let cases = [
        ("a column is missing", refused("1.csv", "x_mm", "x_m")),
        ("a column of the table is missing", refused("plan.toml", "\"split\"", "\"splits\"")),
        ("an unknown unit", refused("plan.toml", "\"mm\"", "\"mn\"")),
        ("a variable that is not there", refused("plan.toml", "\"x\"", "\"xx\"")),
        ("a parameter that is not there", refused("plan.toml", "k          =", "kk =")),
        ("no noise", refused("plan.toml", "sigma = 10", "sigma = 0")),
        ("no table", refused("plan.toml", "table.csv", "tables.csv")),
        ("a recording is not there", refused("table.csv", "2.csv", "3.csv")),
        ("time runs backwards", refused("plan.toml", "\"t\"", "\"x_mm\"")),
        ("a recording without rows", refused("table.csv", "2.csv", "empty.csv")),
        ("nothing to train with", refused("table.csv", "train", "validation")),
        (
            "bounds without room",
            refused("plan.toml", "k          = {}", "k = { min = 2, max = 1 }"),
        ),
        (
            "a list in place of a value",
            refused("plan.toml", "[free]", "[fixed]\nunseen = [1, 2]\n[free]"),
        ),
        (
            "columns of a table that is not there",
            refused(
                "plan.toml",
                "[data]\nfolder = \".\"\ntable  = \"table.csv\"",
                "recordings = [{ file = \"1.csv\" }]\n[data]\nfolder = \".\"",
            ),
        ),
        ("a use that means nothing", refused("table.csv", "1.csv,train", "1.csv,fit")),
        (
            "free for all and for each",
            refused("plan.toml", "\"start(x)\" = {}", "\"start(x)\" = {}\n[free.each]\nk = {}"),
        ),
        (
            "no table of what is free for each",
            refused("plan.toml", "\"start(x)\" = {}", "each = [\"start(x)\"]"),
        ),
        (
            "a start value that is not there",
            refused("plan.toml", "\"start(x)\" = {}", "[free.each]\n\"start(y)\" = {}"),
        ),
        ("a key that means nothing", refused("plan.toml", "sigma", "sigmas")),
        ("not TOML", refused("plan.toml", "[free]", "[free")),
        ("the model is wrong", refused("decay.mo", "-k*x", "-k*y")),
        ("the start cannot be simulated", refused("decay.mo", "-k*x", "-k*sqrt(0.5 - x)")),
    ];
    let said: Vec<String> = cases.iter().map(|(what, said)| format!("## {what}\n{said}")).collect();
    insta::assert_snapshot!(said.join("\n"));
}

#[test]
fn results_go_to_a_folder_called_after_the_plan() {
    let scratch = stand(&decay_model(), PLAN);
    let ended = mocc(scratch.path(), &["calibrate", "plan.toml"]);
    assert_eq!(ended.status, 0, "{}", ended.err);
    let list = std::fs::read_dir(scratch.path().join("plan-calibration")).expect("a folder");
    let mut names: Vec<String> =
        list.flatten().map(|e| e.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    assert_eq!(names, ["calibration.html", "calibration.json", "decay_calibrated.mol"]);
    let page = std::fs::read_to_string(scratch.path().join("plan-calibration/calibration.html"));
    let page = page.expect("a page");
    assert!(page.contains("<svg") && page.contains("x_mm measured"));
    // Behind the tables stand numbers in base64, which may spell anything.
    let (tables, _) = page.split_once("<h2>Recordings</h2>").expect("the recordings");
    let (_, tables) = tables.split_once("</style>").expect("a style");
    assert!(!tables.contains("NaN"));
    // A file in place of the folder.
    scratch.file("taken", "");
    let ended = mocc(scratch.path(), &["calibrate", "plan.toml", "--out", "taken"]);
    assert_eq!((ended.status, ended.out.as_str()), (2, ""));
}

/// Calibrates an example with the healthy recordings; its reduced sums of squares.
fn of_test_stand(plan: &str) -> (f64, f64) {
    let scratch = Scratch::new();
    let plan = format!("{}/examples/{plan}", env!("CARGO_MANIFEST_DIR"));
    let ended = mocc(scratch.path(), &["calibrate", &plan, "--out", "out"]);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    let found = json(scratch.path(), "out");
    assert_eq!(found["complete"], true);
    let chi = |split| number(&found, &format!("/quality/{split}/reduced_chi_square"));
    (chi("train"), chi("validation"))
}

#[test]
fn the_smaller_valve_is_explained_to_the_noise_of_its_sensors() {
    let (train, validation) = of_test_stand("valve32.toml");
    assert!(train <= 1.02 && validation <= 1.10, "{train} {validation}");
}

/// SIGINT ends the fit after its step; the results so far are written.
#[cfg(unix)]
#[test]
fn an_interrupted_search_writes_what_it_has() {
    use std::process::{Command, Stdio};
    use std::time::Duration;

    let scratch = Scratch::new();
    let plan = format!("{}/examples/valve32.toml", env!("CARGO_MANIFEST_DIR"));
    let mut command = Command::new(env!("CARGO_BIN_EXE_mocc"));
    command.current_dir(scratch.path()).args(["calibrate", &plan, "--out", "out"]);
    let running = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let running = running.expect("mocc starts");
    // The folder is created after the handler.
    while !scratch.path().join("out").exists() {
        std::thread::sleep(Duration::from_millis(2));
    }
    let pid = running.id().to_string();
    let sent = Command::new("kill").args(["-INT", &pid]).status().expect("kill is there");
    assert!(sent.success());
    let ended = running.wait_with_output().expect("an end");
    let out = String::from_utf8_lossy(&ended.stdout);
    assert_eq!(ended.status.code(), Some(130), "{out}");
    assert_eq!(String::from_utf8_lossy(&ended.stderr), "");
    assert!(out.contains("interrupted after "), "{out}");
    let found = json(scratch.path(), "out");
    assert_eq!((&found["complete"], &found["converged"]), (&false.into(), &false.into()));
    assert_eq!(found["parameters"].as_array().map(Vec::len), Some(12));
    let model = std::fs::read_to_string(scratch.path().join("out/valve32_calibrated.mol"));
    assert!(model.expect("a model").contains("the fit was interrupted"));
}

/// `cargo test --release the_larger_valve -- --ignored`
#[test]
#[ignore = "takes minutes without optimisation"]
fn the_larger_valve_is_explained_to_the_noise_of_its_sensors() {
    let (train, validation) = of_test_stand("valve52.toml");
    assert!(train <= 1.02 && validation <= 1.10, "{train} {validation}");
}
