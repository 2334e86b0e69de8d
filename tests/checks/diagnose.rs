//! `mocc diagnose`: an oscillator whose recordings come from equations integrated here, with an effect
//! that its model lacks, or with none.

use std::fmt::Write;

use serde_json::Value;

use super::door::{Scratch, suite_model};
use super::program::mocc;

/// Standard deviation of the noise, m.
const SIGMA: f64 = 5e-4;

fn swing_model() -> String {
    suite_model("diagnose/models/swing")
}

const PLAN: &str = r#"
model = "swing.mo"
[data]
folder = "."
table  = "table.csv"
file   = "file"
split  = "split"
[conditions]
s_0 = { parameter = "s_0", unit = "m" }
[time]
column = "t"
unit   = "s"
[signals]
s = { variable = "mass.s", unit = "m", sigma = 5e-4 }
[free]
c = {}
d = {}
"#;

/// Runge and Kutta's classical method for `s'' = -c s - d s' + more(s, s')` from rest at `s_0`, and what a
/// sensor says of it.
fn recording(
    s_0: f64,
    seed: u64,
    more: impl Fn(f64, f64) -> f64,
    says: impl Fn(f64) -> f64,
) -> String {
    let rate = |s: f64, v: f64| (v, -100.0 * s - 2.0 * v + more(s, v));
    let mut state = seed;
    let mut uniform = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let (mut s, mut v) = (s_0, 0.0);
    let mut text = "t,s\n".to_owned();
    let h = 1e-4;
    for k in 0..=20_000 {
        if k % 50 == 0 {
            let normal: f64 = (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
            writeln!(text, "{},{}", k as f64 * h, says(s) + SIGMA * normal).expect("a String");
        }
        let (a1, b1) = rate(s, v);
        let (a2, b2) = rate(s + 0.5 * h * a1, v + 0.5 * h * b1);
        let (a3, b3) = rate(s + 0.5 * h * a2, v + 0.5 * h * b2);
        let (a4, b4) = rate(s + h * a3, v + h * b3);
        s += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
        v += h / 6.0 * (b1 + 2.0 * b2 + 2.0 * b3 + b4);
    }
    text
}

/// The diagnosis of recordings with another force, and the folder it is in.
fn diagnosis(more: impl Fn(f64, f64) -> f64) -> (Value, Scratch) {
    diagnosis_by(more, |s| s)
}

/// The same with a sensor that may be wrong.
fn diagnosis_by(more: impl Fn(f64, f64) -> f64, says: impl Fn(f64) -> f64) -> (Value, Scratch) {
    let scratch = Scratch::new();
    scratch.file("swing.mo", &swing_model());
    scratch.file("plan.toml", PLAN);
    let mut table = "file,split,s_0\n".to_owned();
    for (k, (s_0, split)) in
        [(0.1, "train"), (0.06, "train"), (-0.08, "train"), (0.09, "validation")].iter().enumerate()
    {
        scratch.file(&format!("{k}.csv"), &recording(*s_0, 17 + k as u64, &more, &says));
        writeln!(table, "{k}.csv,{split},{s_0}").expect("a String");
    }
    scratch.file("table.csv", &table);
    let ended = mocc(scratch.path(), &["diagnose", "plan.toml", "--out", "out"]);
    assert_eq!(ended.status, 0, "{}", ended.err);
    let text = std::fs::read_to_string(scratch.path().join("out/diagnosis.json")).expect("a file");
    (serde_json::from_str(&text).expect("JSON"), scratch)
}

#[test]
fn nothing_is_found_where_nothing_is_missing() {
    let (found, _scratch) = diagnosis(|_, _| 0.0);
    assert_eq!(found["verdict"], "complete");
    assert_eq!(found["effects"], Value::Array(Vec::new()));
    assert_eq!(found["amended_model"], Value::Null);
    let chi2 = found["after"]["validation"]["chi2"].as_f64().expect("a number");
    assert!((chi2 - 1.0).abs() < 0.3, "{chi2}");
}

/// The folder of a study with a plan in which `old` is replaced by `new`.
fn study(old: &str, new: &str, more: impl Fn(f64, f64) -> f64) -> Scratch {
    let scratch = Scratch::new();
    scratch.file("swing.mo", &swing_model());
    assert!(PLAN.contains(old));
    scratch.file("plan.toml", &PLAN.replace(old, new));
    let mut table = "file,split,s_0\n".to_owned();
    for (k, (s_0, split)) in
        [(0.1, "train"), (0.06, "train"), (-0.08, "train"), (0.09, "validation")].iter().enumerate()
    {
        scratch.file(&format!("{k}.csv"), &recording(*s_0, 17 + k as u64, &more, |s| s));
        writeln!(table, "{k}.csv,{split},{s_0}").expect("a String");
    }
    scratch.file("table.csv", &table);
    scratch
}

fn found_in(scratch: &Scratch) -> Value {
    let text = std::fs::read_to_string(scratch.path().join("out/diagnosis.json")).expect("a file");
    serde_json::from_str(&text).expect("JSON")
}

/// The sensor is noisier or less noisy than the plan says, and the model lacks nothing.
#[test]
fn white_residuals_of_another_size_are_noise() {
    for (declared, factor) in [("2.5e-4", 2.0), ("1e-3", 0.5)] {
        let scratch = study("sigma = 5e-4", &format!("sigma = {declared}"), |_, _| 0.0);
        let ended = mocc(scratch.path(), &["diagnose", "plan.toml", "--out", "out", "--verbose"]);
        assert_eq!(ended.status, 0, "{}", ended.err);
        let found = found_in(&scratch);
        assert_eq!(found["verdict"], "complete", "{found:#}");
        let noise = found["noise"]["s"].as_f64().expect("a factor");
        assert!((noise / factor - 1.0).abs() < 0.06, "{noise}");
        assert!(!ended.err.contains("short fit"), "no effect is tried: {}", ended.err);
        let line = format!("the noise of s is {noise:.2} times what the plan says");
        assert!(ended.out.contains(&line), "{}", ended.out);
        let page = std::fs::read_to_string(scratch.path().join("out/diagnosis.html"));
        assert!(page.expect("a page").contains(&line["the".len()..]));
    }
}

/// Too little noise in the plan hides no effect: the drag leaves structure, and with it, noise of twice the size.
#[test]
fn an_effect_is_not_taken_for_noise() {
    let scratch = study("sigma = 5e-4", "sigma = 2.5e-4", |_, v| -0.3 * v.abs() * v);
    let ended = mocc(scratch.path(), &["diagnose", "plan.toml", "--out", "out"]);
    assert_eq!(ended.status, 0, "{}", ended.err);
    let found = found_in(&scratch);
    assert_eq!(found["verdict"], "effect_found", "{found:#}");
    let noise = found["noise"]["s"].as_f64().expect("a factor");
    assert!((noise / 2.0 - 1.0).abs() < 0.06, "{noise}");
    let [before, after] =
        ["before", "after"].map(|k| found[k]["train"]["chi2"].as_f64().expect("a number"));
    assert!(before > 1.05 && (after - 1.0).abs() < 0.03, "{found:#}");
}

/// A second sensor shows nothing but noise, three times what the plan says: that is corrected, and the first sensor
/// shows the drag.
#[test]
fn the_noise_of_one_sensor_is_corrected_before_the_search() {
    let scratch = study("c = {}", "c = {}", |_, v| -0.9 * v.abs() * v);
    let noise = "w = { variable = \"silence\", unit = \"1\", sigma = 1 }\n[free]";
    let plan = PLAN.replace("[free]", noise);
    let silence = "  Real silence(start = 0, fixed = true);\nequation\n  der(silence) = 0;\n";
    let model = swing_model().replace("equation\n", silence);
    scratch.file("swing.mo", &model);
    scratch.file("plan.toml", &plan);
    for k in 0..4 {
        let name = format!("{k}.csv");
        let text = std::fs::read_to_string(scratch.path().join(&name)).expect("a file");
        let noise = recording(0.0, 71 + k, |_, _| 0.0, |_| 0.0);
        let both = text.lines().zip(noise.lines()).map(|(line, noise)| {
            match noise.split_once(',').and_then(|(_, x)| x.parse::<f64>().ok()) {
                Some(x) => format!("{line},{}\n", 3.0 * x / SIGMA),
                None => format!("{line},w\n"),
            }
        });
        scratch.file(&name, &both.collect::<String>());
    }
    let ended = mocc(scratch.path(), &["diagnose", "plan.toml", "--out", "out"]);
    assert_eq!(ended.status, 0, "{}", ended.err);
    let found = found_in(&scratch);
    assert_eq!(found["verdict"], "effect_found", "{found:#}");
    assert_eq!(found["effects"][0]["component"], "Effects.QuadraticDrag");
    let factor = found["noise"]["w"].as_f64().expect("a factor");
    assert!((factor / 3.0 - 1.0).abs() < 0.06 && found["noise"].get("s").is_none(), "{factor}");
    assert!((found["after"]["train"]["chi2"].as_f64().expect("a number") - 1.0).abs() < 0.1);
}

/// A search that has no time ends with the calibration, and says so everywhere.
#[test]
fn a_time_limit_ends_the_search() {
    let scratch = study("c = {}", "c = {}", |_, v| -0.9 * v.abs() * v);
    let arguments = ["diagnose", "plan.toml", "--out", "out", "--time-limit", "0"];
    let ended = mocc(scratch.path(), &arguments);
    assert_eq!(ended.status, 0, "{}", ended.err);
    let found = found_in(&scratch);
    assert_eq!((&found["complete"], &found["verdict"]), (&false.into(), &"unexplained".into()));
    let remark = "he search was ended early: this is the best verdict so far";
    let page = std::fs::read_to_string(scratch.path().join("out/diagnosis.html")).expect("a page");
    assert!(ended.out.contains(remark) && page.contains(remark), "{}", ended.out);
    assert!(page.contains("<p class=\"verdict unexplained\">"));
    let ended = mocc(scratch.path(), &["diagnose", "plan.toml", "--time-limit", "-1"]);
    assert_eq!(ended.status, 2, "{}", ended.err);
}

/// A recording for the test changes nothing but what is reported of it.
#[test]
fn nothing_depends_on_the_recordings_of_the_test() {
    let of = |row: &str, force: f64| {
        let scratch = study("sigma = 5e-4", "sigma = 5e-4", |_, _| 0.0);
        let table = std::fs::read_to_string(scratch.path().join("table.csv")).expect("a table");
        scratch.file("table.csv", &format!("{table}{row}"));
        scratch.file("4.csv", &recording(0.07, 41, |_, v| -force * v.abs() * v, |s| s));
        let ended = mocc(scratch.path(), &["diagnose", "plan.toml", "--out", "out"]);
        assert_eq!(ended.status, 0, "{}", ended.err);
        (found_in(&scratch), ended.out)
    };
    let (without, _) = of("", 0.0);
    let (mut healthy, out) = of("4.csv,test,0.07\n", 0.0);
    let (mut other, _) = of("4.csv,test,0.07\n", 0.9);
    assert_eq!(without["before"].get("test"), None);
    let chi2 = |found: &Value| found["after"]["test"]["chi2"].as_f64().expect("a number");
    assert!((chi2(&healthy) - 1.0).abs() < 0.3 && chi2(&other) > 2.0);
    assert_eq!(healthy["after"]["test"]["recordings"][0]["name"], "4.csv");
    assert!(out.contains("    s, test ") && out.contains("    test "), "{out}");
    for found in [&mut healthy, &mut other] {
        for part in ["before", "after"] {
            found[part].as_object_mut().expect("an object").remove("test");
        }
        found["seconds"] = without["seconds"].clone();
        assert_eq!(*found, without);
    }
}

/// What explains only a part is named as such, and not among the effects. While the search goes on, the best
/// verdict so far is told with its evidence.
#[test]
fn a_partial_explanation_is_no_effect() {
    use std::cell::RefCell;

    use mocc::calibrate::observer::{Event, Observer};
    use mocc::diagnose::policy::SearchPolicy;
    use mocc::diagnose::result::Verdict;
    use mocc::diagnose::run::{Request, run};
    use mocc::diagnose::{json, noise, page, summary};
    use mocc::driver::compile::Session;

    let scratch = study("c = {}", "c = {}", |_, v| -0.9 * v.abs() * v);
    let request = Request {
        plan: scratch.path().join("plan.toml"),
        memory: Default::default(),
        data: None,
        effects: None,
        modelica_path: None,
        policy: SearchPolicy::default(),
        next: false,
    };
    #[derive(Default)]
    struct Watcher(RefCell<Vec<String>>);

    impl Observer for Watcher {
        fn event(&self, event: &Event<'_>) {
            if let Event::Best(text) = event {
                self.0.borrow_mut().push((*text).to_owned());
            }
        }
    }

    let watcher = Watcher::default();
    let mut outcome = run(&request, &mut Session::default(), &watcher).expect("an outcome");
    assert_eq!(outcome.verdict(), Verdict::EffectFound);
    let told = watcher.0.borrow();
    let first = told.first().map(String::as_str).unwrap_or_default();
    assert!(first.starts_with("unexplained, reduced chi-square "), "{told:?}");
    let last = told.last().map(String::as_str).unwrap_or_default();
    assert!(last.starts_with("effect_found, ") && last.ends_with(" (validation)"), "{told:?}");
    // As if more had been asked.
    outcome.study.policy.resolved_validation = 0.0;
    outcome.study.policy.resolved_deviations = f64::NEG_INFINITY;
    outcome.study.policy.explained_limit = 0.0;
    outcome.diagnosis.noise = noise::Noise::default();
    let text = json::json(&outcome, None, 1.0);
    let found: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(found["verdict"], "unexplained");
    assert_eq!(found["effects"], Value::Array(Vec::new()));
    assert_eq!(found["alternatives"][0]["component"], "Effects.QuadraticDrag", "{found:#}");
    assert_eq!(found["alternatives"][0]["delta_bic"], 0.0);
    let summary = summary::summary(&outcome, 1.0);
    let lines: Vec<&str> = summary.lines().collect();
    assert_eq!(lines[0], "Swing: unexplained");
    assert!(lines[1].starts_with("  partial explanation: "), "{summary}");
    assert!(lines.iter().any(|l| l.starts_with("    s, train ") && l.ends_with(" m")), "{summary}");
    let page = page::html(&outcome);
    assert!(page.contains("<p class=\"verdict unexplained\">unexplained</p>"));
    assert!(page.contains("<p>Partial explanation: "));
}

/// `-0.9 |v| v`: drag of a turbulent flow.
#[test]
fn a_quadratic_drag_is_found_and_the_amended_model_runs() {
    let (found, scratch) = diagnosis(|_, v| -0.9 * v.abs() * v);
    assert_eq!(found["verdict"], "effect_found", "{found:#}");
    let effect = &found["effects"][0];
    assert_eq!(effect["component"], "Effects.QuadraticDrag", "{found:#}");
    assert_eq!(effect["at"][0], "mass");
    let (_, parameter) =
        effect["parameters"].as_object().and_then(|p| p.iter().next()).expect("a parameter");
    let [value, error] = ["value", "stderr"].map(|k| parameter[k].as_f64().expect("a number"));
    assert!((value - 0.9).abs() < 4.0 * error && error < 0.1, "{value} +- {error}");
    let (before, after) = (&found["before"], &found["after"]);
    assert!(before["validation"]["chi2"].as_f64() > Some(2.0));
    assert!(after["validation"]["chi2"].as_f64() < Some(1.3));
    let multiple = after["train"]["signals"]["s"]["noise_multiple"].as_f64();
    assert!(multiple.is_some_and(|m| (m - 1.0).abs() < 0.1), "{multiple:?}");

    // Before that: the balance that does not close, and over what the missing force is a curve.
    let balance = &found["balances"][0];
    assert_eq!(
        (&balance["at"], &balance["inflow"]),
        (&"mass".into(), &"Effects.UnknownForce".into())
    );
    assert!(balance["explained"].as_f64() > Some(0.9), "{balance}");
    assert_eq!(balance["ordered_by"], "v");

    let amended = found["amended_model"].as_str().expect("a name");
    assert_eq!(amended, "Swing_with_QuadraticDrag.mol");
    let ended = mocc(&scratch.path().join("out"), &["simulate", amended]);
    assert_eq!(ended.status, 0, "{}", ended.err);
    let page = std::fs::read_to_string(scratch.path().join("out/diagnosis.html")).expect("a page");
    assert!(page.contains("Effects.QuadraticDrag"));
    // The page shows the additions as a difference, and the residuals of each recording.
    assert!(page.contains("<span class=\"plus\">+model Swing_with_QuadraticDrag "));
    assert!(!page.contains("class=\"minus\""), "nothing of the original was removed");
    assert!(page.contains("id=\"residual-0\"") && page.contains("\"name\":\"after\""));
}

/// The effects that were found, each with the value of its first parameter, by class.
fn effects(found: &Value) -> Vec<(String, f64)> {
    let one = |e: &Value| {
        let parameters = e["parameters"].as_object().expect("an object");
        let first = parameters.values().next().expect("a parameter");
        let class = e["component"].as_str().expect("a class");
        (class.to_owned(), first["value"].as_f64().expect("a number"))
    };
    let mut all: Vec<_> = found["effects"].as_array().expect("a list").iter().map(one).collect();
    all.sort_by(|a, b| a.0.cmp(&b.0));
    all
}

/// Scale and zero of one sensor are both wrong: one effect hides the other.
#[test]
fn two_effects_of_one_sensor_are_found() {
    let (found, scratch) = diagnosis_by(|_, _| 0.0, |s| 1.04 * (s + 0.002));
    assert_eq!(found["verdict"], "effect_found", "{found:#}");
    let effects = effects(&found);
    let [(gain, g), (offset, o)] = effects.as_slice() else { panic!("{effects:?}") };
    assert_eq!((gain.as_str(), offset.as_str()), ("Effects.SensorGain", "Effects.SensorOffset"));
    // Which stands first is not to be seen: the offset is as the sensor says it, or as it is.
    assert!((g - 0.04).abs() < 0.005 && (o - 0.00204).abs() < 2e-4, "{effects:?}");
    assert!(found["after"]["validation"]["chi2"].as_f64() < Some(1.3));
    let amended = found["amended_model"].as_str().expect("a name");
    let ended = mocc(&scratch.path().join("out"), &["simulate", amended]);
    assert_eq!(ended.status, 0, "{}", ended.err);

    // Judged on the same recordings, the amended model is as good as the diagnosis says: with its sensor.
    let amended = format!("out/{amended}");
    let arguments = ["evaluate", &amended, "--plan", "plan.toml", "--json", "judged.json"];
    let ended = mocc(scratch.path(), &arguments);
    assert_eq!(ended.status, 0, "{}", ended.err);
    let text = std::fs::read_to_string(scratch.path().join("judged.json")).expect("a file");
    let judged: Value = serde_json::from_str(&text).expect("JSON");
    let rmse = judged["recordings"][3]["signals"]["s"]["rmse"].as_f64().expect("a number");
    let expected = found["after"]["validation"]["signals"]["s"]["rmse"].as_f64().expect("a number");
    assert!((rmse / expected - 1.0).abs() < 1e-4, "{rmse} {expected}");
}

/// A drag and the zero of the sensor, neither of which explains much without the other.
#[test]
fn two_effects_at_once_are_found() {
    let (found, _scratch) = diagnosis_by(|_, v| -0.9 * v.abs() * v, |s| s + 0.003);
    let mut effects = effects(&found);
    effects.sort_by(|a, b| a.0.cmp(&b.0));
    let [(drag, k), (offset, o)] = effects.as_slice() else { panic!("{effects:?}") };
    assert_eq!((drag.as_str(), offset.as_str()), ("Effects.QuadraticDrag", "Effects.SensorOffset"));
    assert!((k - 0.9).abs() < 0.1 && (o - 0.003).abs() < 2e-4, "{effects:?}");
    assert!(found["after"]["validation"]["chi2"].as_f64() < Some(1.3));
}

/// The output for a plan, a model or a recording in which `old` is replaced by `new`.
fn refused(file: &str, old: &str, new: &str) -> String {
    let scratch = Scratch::new();
    let recording = recording(0.1, 5, |_, _| 0.0, |s| s);
    let files = [
        ("swing.mo", &*swing_model()),
        ("plan.toml", PLAN),
        ("table.csv", "file,split,s_0\n1.csv,train,0.1\n"),
        ("1.csv", &recording),
    ];
    for (name, text) in files {
        assert!(name != file || text.contains(old), "{file} has no {old}");
        let text = if name == file { text.replacen(old, new, 1) } else { text.to_owned() };
        scratch.file(name, &text);
    }
    let ended = mocc(scratch.path(), &["diagnose", "plan.toml", "--out", "out"]);
    let written = scratch.path().join("out/diagnosis.json").exists();
    assert!(ended.out.is_empty() && !written, "{}", ended.out);
    format!("status {}\n{}", ended.status, ended.err)
}

#[test]
fn invalid_studies_are_rejected_with_place_and_remedy() {
    let cases = [
        ("a column is missing", refused("1.csv", "t,s", "t,x")),
        ("an unknown unit", refused("plan.toml", "unit = \"m\", sigma", "unit = \"mn\", sigma")),
        ("a variable that is not there", refused("plan.toml", "mass.s", "mass.x")),
        ("a parameter that is not there", refused("plan.toml", "c = {}", "cc = {}")),
        ("no noise", refused("plan.toml", "sigma = 5e-4", "sigma = 0")),
        ("time runs backwards", refused("plan.toml", "column = \"t\"", "column = \"s\"")),
        (
            "the model is wrong",
            refused("swing.mo", "connect(spring.flange_b", "connect(spring.flange_c"),
        ),
        (
            "the start cannot be simulated",
            refused("swing.mo", "equation", "equation\n  assert(mass.s > 0, \"too far\");"),
        ),
    ];
    let said: Vec<String> = cases.iter().map(|(what, said)| format!("## {what}\n{said}")).collect();
    insta::assert_snapshot!(said.join("\n"));
}

/// Values that are not numbers, a gap and rows out of order are repaired and reported; a free parameter
/// that affects nothing does not keep the drag from being found.
#[test]
fn recordings_are_repaired_and_idle_parameters_borne() {
    let scratch = Scratch::new();
    let model = swing_model()
        .replace("  Translational.Mass ", "  parameter Real idle = 1;\n  Translational.Mass ");
    scratch.file("swing.mo", &model);
    scratch.file("plan.toml", &PLAN.replace("d = {}", "d = {}\nidle = {}"));
    let mut table = "file,split,s_0\n".to_owned();
    for (k, (s_0, split)) in
        [(0.1, "train"), (-0.08, "train"), (0.09, "validation")].iter().enumerate()
    {
        let text = recording(*s_0, 29 + k as u64, |_, v| -0.9 * v.abs() * v, |s| s);
        let mut lines: Vec<&str> = text.lines().collect();
        lines.drain(200..230);
        lines.swap(50, 51);
        let text =
            lines.join("\n").replacen(lines[20].split(',').nth(1).expect("a value"), "NaN", 1);
        scratch.file(&format!("{k}.csv"), &text);
        writeln!(table, "{k}.csv,{split},{s_0}").expect("a String");
    }
    scratch.file("table.csv", &table);
    let ended = mocc(scratch.path(), &["diagnose", "plan.toml", "--out", "out"]);
    assert_eq!(ended.status, 0, "{}", ended.err);
    let text = std::fs::read_to_string(scratch.path().join("out/diagnosis.json")).expect("a file");
    let found: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(found["effects"][0]["component"], "Effects.QuadraticDrag", "{found:#}");
    assert_eq!(found["repairs"].as_array().map(Vec::len), Some(9), "{}", found["repairs"]);
}

/// SIGINT and SIGTERM end the search after its step; what was found is written and marked.
#[cfg(unix)]
#[test]
fn an_interrupted_diagnosis_writes_what_it_has() {
    use std::process::{Command, Stdio};
    use std::time::Duration;

    for signal in ["-INT", "-TERM"] {
        let scratch = Scratch::new();
        let plan = format!("{}/examples/valve32.toml", env!("CARGO_MANIFEST_DIR"));
        let mut command = Command::new(env!("CARGO_BIN_EXE_mocc"));
        command.current_dir(scratch.path()).args(["diagnose", &plan, "--out", "out"]);
        let running = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
        let running = running.expect("mocc starts");
        // The folder is made after the handler.
        while !scratch.path().join("out").exists() {
            std::thread::sleep(Duration::from_millis(2));
        }
        std::thread::sleep(Duration::from_millis(50));
        let pid = running.id().to_string();
        let sent = Command::new("kill").args([signal, &pid]).status().expect("kill is there");
        assert!(sent.success());
        let ended = running.wait_with_output().expect("an end");
        assert_eq!(ended.status.code(), Some(130), "{}", String::from_utf8_lossy(&ended.stderr));
        let text =
            std::fs::read_to_string(scratch.path().join("out/diagnosis.json")).expect("a file");
        let found: Value = serde_json::from_str(&text).expect("JSON");
        assert_eq!(found["complete"], false);
    }
}

/// Restricted to some effects, the search finds the best of these, and names none that does not exist.
#[test]
fn a_search_may_be_restricted() {
    let scratch = study("d = {}", "d = {}", |_, v| -0.9 * v.abs() * v);
    let diagnose = |only: &str| {
        mocc(scratch.path(), &["diagnose", "plan.toml", "--out", "out", "--only", only])
    };
    let found = |only: &str| -> Value {
        let ended = diagnose(only);
        assert_eq!(ended.status, 0, "{}", ended.err);
        assert!(ended.out.contains(&format!("restricted to {only}")), "{}", ended.out);
        let text = std::fs::read_to_string(scratch.path().join("out/diagnosis.json"));
        serde_json::from_str(&text.expect("a file")).expect("JSON")
    };
    let of_drag = found("QuadraticDrag");
    assert_eq!(of_drag["effects"][0]["component"], "Effects.QuadraticDrag", "{of_drag:#}");
    let of_parameters = found("parameter");
    let effects = of_parameters["effects"].as_array().expect("a list");
    assert!(effects.iter().all(|e| e["component"] == "parameter"), "{of_parameters:#}");
    let ended = diagnose("QuadraticDrga");
    assert_eq!(ended.status, 2);
    assert!(
        ended.err.contains("error[MO1023]: there is no effect `QuadraticDrga`"),
        "{}",
        ended.err
    );
    assert!(ended.err.contains("did you mean `QuadraticDrag`?"), "{}", ended.err);
}

/// A catalogue of the user's own: the effect is one more model with an annotation.
#[test]
fn a_users_effect_is_found_too() {
    let effect = &suite_model("diagnose/models/cubic_spring");
    let scratch = Scratch::new();
    scratch.file("effects/Cubic.mo", effect);
    let broken = effect.replace("Cubic", "Broken").replace("amplitude=k", "amplitude=k; w=max(s");
    scratch.file("effects/Broken.mo", &broken);
    let folder = scratch.path().join("effects");
    let mut table = "file,split,s_0\n".to_owned();
    scratch.file("swing.mo", &swing_model());
    scratch.file("plan.toml", PLAN);
    for (k, (s_0, split)) in
        [(0.1, "train"), (0.05, "train"), (0.08, "validation")].iter().enumerate()
    {
        let text = recording(*s_0, 3 + k as u64, |s, _| -4000.0 * s * s * s, |s| s);
        scratch.file(&format!("{k}.csv"), &text);
        writeln!(table, "{k}.csv,{split},{s_0}").expect("a String");
    }
    scratch.file("table.csv", &table);
    let folder = folder.display().to_string();
    let arguments = ["diagnose", "plan.toml", "--out", "out", "--effects", &folder];
    let ended = mocc(scratch.path(), &arguments);
    assert_eq!(ended.status, 0, "{}", ended.err);
    let text = std::fs::read_to_string(scratch.path().join("out/diagnosis.json")).expect("a file");
    let found: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(found["effects"][0]["component"], "Cubic", "{found:#}");
    let warning = "warning[MO1019]: cannot use `Broken`: cannot read the entry `w=max(s`";
    assert!(ended.err.contains(warning) && ended.err.contains("Broken.mo:"), "{}", ended.err);
    assert_eq!(found["effects"][0]["explains"], "The spring at mass hardens.");
}

/// The workflow as another front end calls it: nothing is written, progress and the end of the search are up to
/// the observer, and the result is typed.
#[test]
fn a_front_end_observes_and_cancels() {
    use std::cell::Cell;

    use mocc::base::diag::Problems;
    use mocc::base::source::SourceMap;
    use mocc::calibrate::observer::{Event, Observer};
    use mocc::diagnose::policy::SearchPolicy;
    use mocc::diagnose::result::Verdict;
    use mocc::diagnose::run::{Request, run};
    use mocc::driver::compile::Session;

    #[derive(Default)]
    struct FrontEnd {
        started: Cell<bool>,
        notes: Cell<usize>,
        refuses: bool,
    }

    impl Observer for FrontEnd {
        fn start(&self, problems: &Problems, _: &SourceMap) -> Result<(), String> {
            self.started.set(problems.is_empty());
            if self.refuses { Err("not today".to_owned()) } else { Ok(()) }
        }
        fn event(&self, event: &Event<'_>) {
            self.notes.set(self.notes.get() + usize::from(matches!(event, Event::Note(_))));
        }
        fn is_cancelled(&self) -> bool {
            self.notes.get() > 2
        }
    }

    let scratch = Scratch::new();
    scratch.file("swing.mo", &swing_model());
    scratch.file("plan.toml", PLAN);
    scratch.file("0.csv", &recording(0.1, 17, |_, v| -0.9 * v.abs() * v, |s| s));
    scratch.file("table.csv", "file,split,s_0\n0.csv,train,0.1\n");
    let request = Request {
        plan: scratch.path().join("plan.toml"),
        memory: Default::default(),
        data: None,
        effects: None,
        modelica_path: None,
        policy: SearchPolicy::default(),
        next: false,
    };
    let front_end = FrontEnd::default();
    let outcome = run(&request, &mut Session::default(), &front_end).expect("an outcome");
    assert!(front_end.started.get() && !outcome.complete);
    assert_eq!(outcome.verdict(), Verdict::Unexplained);
    let refusing = FrontEnd { refuses: true, ..FrontEnd::default() };
    let refused = run(&request, &mut Session::default(), &refusing);
    assert_eq!(refused.map(|_| ()).map_err(|e| e.to_string()), Err("not today".to_owned()));
    assert_eq!(refusing.notes.get(), 0);
}

/// The verdicts on the recordings of the test stand; minutes without optimisation:
/// `cargo test --release -- --ignored stand`.
#[test]
#[ignore = "eight diagnoses of a minute each"]
fn the_stand_is_diagnosed() {
    let here = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let cases = [
        ("valve52", "healthy", "complete", ""),
        ("valve32", "healthy32", "complete", ""),
        ("valve52", "case-a", "effect_found", "FlowForceEdge"),
        ("valve52", "case-b", "effect_found", "Leak"),
        ("valve52", "case-c", "effect_found", "Detent"),
        ("valve52", "case-d", "effect_found", "parameter"),
        ("valve52", "case-e", "effect_found", "Pneumatics.Source"),
        ("valve52", "case-f", "effect_found", "Friction.LuGre"),
    ];
    for (plan, data, verdict, effect) in cases {
        let scratch = Scratch::new();
        let out = scratch.path().display().to_string();
        let plan = format!("examples/{plan}.toml");
        let data = format!("tests/data/teststand/{data}");
        let ended = mocc(here, &["diagnose", &plan, "--data", &data, "--out", &out]);
        assert_eq!(ended.status, 0, "{}", ended.err);
        let text = std::fs::read_to_string(scratch.path().join("diagnosis.json")).expect("a file");
        let found: Value = serde_json::from_str(&text).expect("JSON");
        assert_eq!(found["verdict"], verdict, "{data}");
        let component = found["effects"][0]["component"].as_str().unwrap_or_default();
        assert!(component.contains(effect), "{data}: {component}");
        let chi2 = |when: &str| found[when]["validation"]["chi2"].as_f64().expect("a number");
        let removed = 1.0 - (chi2("after") - 1.0) / (chi2("before") - 1.0);
        assert!(effect.is_empty() || removed > 0.98, "{data}: {removed}");
    }
}
