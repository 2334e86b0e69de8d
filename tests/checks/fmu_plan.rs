//! FMUs as the models of plans: a heater that is exported, and recordings of it from equations integrated here, with a
//! flaw of a sensor, of an actuator or of a parameter. Skips where the runtime of FMUs has not been built.

use std::fmt::Write;

use mocc::io::csv::read_csv;
use serde_json::Value;

use super::door::{Reading, Scratch};
use super::program::{Ended, fmu_runtime, mocc};

/// Standard deviation of the noise, K.
const SIGMA: f64 = 0.05;
/// Distance of the rows, s. The corners of the power are at rows.
const ROW: f64 = 6.0;
/// Length of a recording, s.
const LENGTH: f64 = 360.0;

const HEATER: &str = r#"model Heater "A heated body in a room"
  parameter Real C(unit = "J/K") = 400 "Heat capacity";
  parameter Real G(unit = "W/K") = 1.5 "Conductance to the room";
  parameter Real T_room(unit = "K") = 293 "Temperature of the room";
  input Real P(unit = "W", start = 0) "Heating power";
  output Real T(unit = "K", start = T_room, fixed = true) "Temperature";
equation
  C*der(T) = P - G*(T - T_room);
  annotation(experiment(StopTime = 600));
end Heater;
"#;

const PLAN: &str = r#"
model = "MODEL"
[data]
folder = "."
table  = "table.csv"
file   = "file"
split  = "split"
[conditions]
T_room = { parameter = "T_room", unit = "K" }
[inputs]
P = { input = "P", unit = "W", interpolation = "linear" }
[time]
column = "t"
unit   = "s"
[signals]
T = { variable = "T", unit = "K", sigma = 0.05 }
[free]
C = { min = 50, max = 2000 }
G = { min = 0.1, max = 20 }
"#;

/// The heating power of a recording, W: ramps between levels, some of them small and negative.
fn power(recording: usize, t: f64) -> f64 {
    let levels = [
        [0.0, 90.0, 20.0, 60.0, 5.0, 40.0],
        [40.0, 8.0, 100.0, 30.0, 70.0, 12.0],
        [10.0, 60.0, 0.0, 25.0, 90.0, 50.0],
        [70.0, 15.0, 45.0, 80.0, 3.0, 30.0],
    ];
    let levels = &levels[recording % levels.len()];
    let at = t / 60.0;
    let k = (at as usize).min(levels.len() - 1);
    // A fifth of each interval is a ramp.
    let part = ((at - k as f64) / 0.2).min(1.0);
    let before = if k == 0 { levels[0] } else { levels[k - 1] };
    before + part * (levels[k] - before)
}

/// What differs from the heater of the model.
#[derive(Clone, Copy)]
struct Flaws {
    /// Time constant of the sensor, s.
    lag: f64,
    /// Half the width of the dead zone of the heating, W.
    dead: f64,
    /// Relative growth of the conductance, 1/K.
    growth: f64,
}

const FLAWLESS: Flaws = Flaws { lag: 0.0, dead: 0.0, growth: 0.0 };

/// A recording, integrated by Runge and Kutta's classical method.
fn recording(number: usize, room: f64, flaws: Flaws) -> String {
    let mut state = 17 + number as u64;
    let mut uniform = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let rate = |t: f64, (x, y): (f64, f64)| {
        let p = power(number, t);
        let acts = p - p.clamp(-flaws.dead, flaws.dead);
        let conductance = 2.0 * (1.0 + flaws.growth * (x - 293.0));
        let lag = if flaws.lag > 0.0 { (x - y) / flaws.lag } else { 0.0 };
        ((acts - conductance * (x - room)) / 500.0, lag)
    };
    let mut x = (room, room);
    let mut text = "t,P,T\n".to_owned();
    let (h, steps) = (0.25, (ROW / 0.25) as usize);
    for k in 0..=(LENGTH / h) as usize {
        let t = k as f64 * h;
        if k % steps == 0 {
            let normal: f64 = (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
            let shown = if flaws.lag > 0.0 { x.1 } else { x.0 };
            writeln!(text, "{t},{},{}", power(number, t), shown + SIGMA * normal)
                .expect("a String");
        }
        let along = |f: f64, d: (f64, f64)| (x.0 + f * h * d.0, x.1 + f * h * d.1);
        let a = rate(t, x);
        let b = rate(t + 0.5 * h, along(0.5, a));
        let c = rate(t + 0.5 * h, along(0.5, b));
        let d = rate(t + h, along(1.0, c));
        x.0 += h / 6.0 * (a.0 + 2.0 * b.0 + 2.0 * c.0 + d.0);
        x.1 += h / 6.0 * (a.1 + 2.0 * b.1 + 2.0 * c.1 + d.1);
    }
    text
}

/// A folder with the heater as an FMU, the recordings and the plans; `None` without the runtime.
fn study(flaws: Flaws) -> Option<Scratch> {
    study_of("both", flaws)
}

/// The same with an FMU of a kind: `me`, `cs` or `both`.
fn study_of(kind: &str, flaws: Flaws) -> Option<Scratch> {
    let runtime = fmu_runtime()?;
    let folder = Scratch::new();
    folder.file("heater.mo", HEATER);
    let runtime = runtime.display().to_string();
    let ended = mocc(
        folder.path(),
        &[
            "export",
            "fmu",
            "heater.mo",
            "--runtime",
            &runtime,
            "-o",
            "heater.fmu",
            "--quiet",
            "--type",
            kind,
        ],
    );
    assert_eq!(ended.status, 0, "{}", ended.err);
    let mut table = "file,split,T_room\n".to_owned();
    for (k, room) in [293.0, 285.0, 299.0, 290.0].into_iter().enumerate() {
        folder.file(&format!("{k}.csv"), &recording(k, room, flaws));
        let split = if k == 3 { "validation" } else { "train" };
        writeln!(table, "{k}.csv,{split},{room}").expect("a String");
    }
    folder.file("table.csv", &table);
    folder.file("plan.toml", &PLAN.replace("MODEL", "heater.fmu"));
    folder.file("text.toml", &PLAN.replace("MODEL", "heater.mo"));
    Some(folder)
}

fn json(folder: &Scratch, file: &str) -> Value {
    let text = std::fs::read_to_string(folder.path().join(file)).expect(file);
    serde_json::from_str(&text).expect("JSON")
}

fn succeeds(folder: &Scratch, words: &[&str]) -> Ended {
    let ended = mocc(folder.path(), words);
    assert_eq!(ended.status, 0, "{}\n{}", ended.out, ended.err);
    ended
}

/// The diagnosis of the heater with flaws: what was found, and the summary.
fn diagnosis(flaws: Flaws) -> Option<(Value, String, Scratch)> {
    let folder = study(flaws)?;
    let words = ["diagnose", "plan.toml", "--allow-fmu", "heater.fmu", "--out", "out"];
    let ended = succeeds(&folder, &words);
    Some((json(&folder, "out/diagnosis.json"), ended.out, folder))
}

fn first_effect(found: &Value) -> (&str, &str) {
    assert_eq!(found["verdict"], "effect_found", "{found:#}");
    let effect = &found["effects"][0];
    let text = |x: &'static str| effect[x].as_str().unwrap_or_default();
    (text("component"), effect["at"][0].as_str().unwrap_or_default())
}

/// The FMU and the text are one model: the estimates agree within a small part of their errors.
#[test]
fn an_fmu_is_calibrated_like_its_model() {
    let Some(folder) = study(FLAWLESS) else { return };
    let refused = mocc(folder.path(), &["calibrate", "plan.toml"]);
    assert_eq!(refused.status, 2);
    assert!(
        refused.err.contains("MO1321") && refused.err.contains("--allow-fmu"),
        "{}",
        refused.err
    );
    // Without its code, the plan can be checked.
    succeeds(&folder, &["check", "plan.toml"]);
    folder.file("wrong.toml", &PLAN.replace("MODEL", "heater.fmu").replace("G = {", "H = {"));
    let wrong = mocc(folder.path(), &["check", "wrong.toml"]);
    assert!(wrong.status == 2 && wrong.err.contains("`H`"), "{}", wrong.err);
    let words = ["calibrate", "plan.toml", "--allow-fmu", "heater.fmu", "--no-profiles"];
    succeeds(&folder, &[&words[..], &["--out", "a"]].concat());
    succeeds(&folder, &["calibrate", "text.toml", "--no-profiles", "--out", "b"]);
    let [fmu, text] = ["a", "b"].map(|f| json(&folder, &format!("{f}/calibration.json")));
    for (k, truth) in [500.0, 2.0].into_iter().enumerate() {
        let of = |found: &Value, key: &str| found["parameters"][k][key].as_f64().expect("a number");
        let error = of(&text, "standard_error");
        assert!((of(&fmu, "value") - of(&text, "value")).abs() < 0.02 * error, "{fmu:#}\n{text:#}");
        assert!((of(&fmu, "standard_error") - error).abs() < 0.02 * error, "{fmu:#}\n{text:#}");
        assert!((of(&text, "value") - truth).abs() < 4.0 * error, "{text:#}");
    }
}

/// Adds a model with the FMU inside, and its plan.
fn put_inside(folder: &Scratch) {
    succeeds(folder, &["import", "heater.fmu", "-o", "Block.mo", "--name", "Heater", "--quiet"]);
    let block = std::fs::read_to_string(folder.path().join("Block.mo")).expect("a block");
    let plant = "model Plant
  parameter Real C = 400;
  parameter Real G = 1.5;
  parameter Real T_room = 293;
  input Real P(start = 0);
  output Real T;
  Heater heater(C = C, G = G, T_room = T_room, communicationStep = 0.5);
equation
  heater.P = P;
  T = heater.T;
end Plant;
";
    folder.file("plant.mo", &format!("{block}{plant}"));
    folder.file("inside.toml", &PLAN.replace("MODEL", "plant.mo"));
}

/// A model with an FMU inside: what acts on the FMU has derivatives too, by differences.
#[test]
fn derivatives_go_through_an_fmu_inside_a_model() {
    let Some(folder) = study(FLAWLESS) else { return };
    put_inside(&folder);
    let words = ["calibrate", "inside.toml", "--allow-fmu", "heater.fmu", "--no-profiles"];
    succeeds(&folder, &[&words[..], &["--out", "c"]].concat());
    let found = json(&folder, "c/calibration.json");
    for (k, truth) in [500.0, 2.0].into_iter().enumerate() {
        let value = found["parameters"][k]["value"].as_f64().expect("a number");
        assert!((value - truth).abs() < 0.01 * truth, "{found:#}");
    }
}

/// The bounces of a ball lie between the communication points of its FMU: after the first, at `t1 = sqrt(2 h/g)`, the ball
/// rises with `v1 = e g t1`, and its height is `v1 (t - t1) - g (t - t1)^2/2`.
#[test]
fn an_fmu_for_model_exchange_alone_has_its_events_inside_a_model() {
    let Some(runtime) = fmu_runtime() else { return };
    let (folder, runtime) = (Scratch::new(), runtime.display().to_string());
    let ball = "model Ball
  parameter Real e = 0.8;
  output Real h(start = 1, fixed = true);
  output Integer bounces(start = 0, fixed = true);
  Real v(start = 0, fixed = true);
equation
  der(h) = v;
  der(v) = -9.81;
  when h < 0 then
    reinit(v, -e*pre(v));
    bounces = pre(bounces) + 1;
  end when;
end Ball;
";
    folder.file("ball.mo", ball);
    for fmi in ["2", "3"] {
        let of = ["export", "fmu", "ball.mo", "--runtime", &runtime, "-o", "ball.fmu", "--quiet"];
        succeeds(&folder, &[&of[..], &["--fmi", fmi, "--type", "me"]].concat());
        succeeds(&folder, &["import", "ball.fmu", "-o", "Block.mo", "--name", "Court", "--quiet"]);
        let block = std::fs::read_to_string(folder.path().join("Block.mo")).expect("a block");
        let plant = "model Plant
  Court court(e = 0.7, communicationStep = 0.1);
  Real h = court.h;
  Integer bounces = court.bounces;
end Plant;
";
        folder.file("plant.mo", &format!("{block}{plant}"));
        let words = ["simulate", "plant.mo", "--model", "Plant", "--allow-fmu", "ball.fmu"];
        succeeds(&folder, &[&words[..], &["--stop", "1", "-o", "run.csv", "--quiet"]].concat());
        let run = read_csv(folder.path().join("run.csv")).expect("a table");
        let (g, t1) = (9.81, (2.0_f64 / 9.81).sqrt());
        let height = 0.7 * g * t1 * (1.0 - t1) - g * (1.0 - t1).powi(2) / 2.0;
        let found = run.last("h");
        assert!((found - height).abs() < 1e-6, "FMI {fmi}: {found} is not {height}");
        assert_eq!(run.last("bounces"), 1.0, "FMI {fmi}");
    }
}

#[test]
fn a_lag_of_the_sensor_of_an_fmu_is_found() {
    let Some((found, summary, folder)) = diagnosis(Flaws { lag: 30.0, ..FLAWLESS }) else { return };
    let (component, at) = first_effect(&found);
    assert_eq!((component, at), ("Effects.SensorLag", "T"), "{found:#}");
    assert!(summary.contains("inside an FMU nothing can be added"), "{summary}");
    assert_eq!(found["fmu"], "heater.fmu");
    let amended = found["amended_model"].as_str().expect("an amended model");
    let file = format!("out/{amended}");
    let words = ["simulate", &file, "--quiet", "--output", "run.csv"];
    let refused = mocc(folder.path(), &words);
    assert_eq!(refused.status, 1, "an amended model does not run foreign code by itself");
    succeeds(&folder, &[&words[..], &["--allow-fmu", "heater.fmu"]].concat());
    let words = ["evaluate", "plan.toml", "--model", &file, "--allow-fmu", "heater.fmu"];
    succeeds(&folder, &words);
}

#[test]
fn a_dead_zone_before_an_fmu_is_found() {
    let Some((found, ..)) = diagnosis(Flaws { dead: 12.0, ..FLAWLESS }) else { return };
    let (component, at) = first_effect(&found);
    assert_eq!((component, at), ("Effects.ActuatorDeadZone", "P"), "{found:#}");
}

/// An FMU that cannot integrate itself is integrated between its communication points, with the result of one that can.
#[test]
fn an_fmu_for_model_exchange_alone_is_integrated_inside_a_model() {
    let misfit = |kind: &str| {
        let folder = study_of(kind, Flaws { dead: 12.0, ..FLAWLESS })?;
        put_inside(&folder);
        let words = ["evaluate", "inside.toml", "--allow-fmu", "heater.fmu", "--json"];
        let ended = succeeds(&folder, &words);
        let found: Value = serde_json::from_str(&ended.out).expect("JSON");
        if kind == "me" {
            let words = ["diagnose", "plan.toml", "--allow-fmu", "heater.fmu", "--out", "out"];
            succeeds(&folder, &[&words[..], &["--time-limit", "1"]].concat());
            assert_eq!(json(&folder, "out/diagnosis.json")["fmu"], "heater.fmu");
        }
        found["reduced_chi_square"].as_f64()
    };
    let (Some(here), Some(there)) = (misfit("me"), misfit("cs")) else { return };
    assert!(there > 10.0 && (here / there - 1.0).abs() < 1e-3, "{here} is not {there}");
}

#[test]
fn a_parameter_of_an_fmu_that_varies_is_found() {
    let Some((found, ..)) = diagnosis(Flaws { growth: 0.02, ..FLAWLESS }) else { return };
    let (component, at) = first_effect(&found);
    assert_eq!((component, at), ("parameter", "G"), "{found:#}");
    assert_eq!(found["effects"][0]["over"][0], "T", "{found:#}");
}

#[test]
fn nothing_is_found_where_an_fmu_lacks_nothing() {
    let Some((found, ..)) = diagnosis(FLAWLESS) else { return };
    assert_eq!(found["verdict"], "complete", "{found:#}");
}

/// Rows of a recording that lie between, on, and within rounding of the instants that an FMU for Co-Simulation alone
/// stops at: the solution of the equation fits them exactly, whatever their distance.
#[test]
fn every_row_of_an_fmu_that_steps_itself_is_compared() {
    let Some(runtime) = fmu_runtime() else { return };
    let (folder, runtime) = (Scratch::new(), runtime.display().to_string());
    let tank = "model Tank
  parameter Real k(unit = \"1/s\") = 0.8;
  output Real x(unit = \"m\", start = 2, fixed = true);
equation
  der(x) = -k*x;
  annotation(experiment(StopTime = 4));
end Tank;
";
    folder.file("tank.mo", tank);
    for fmi in ["2", "3"] {
        let of = ["export", "fmu", "tank.mo", "--runtime", &runtime, "-o", "tank.fmu", "--quiet"];
        succeeds(&folder, &[&of[..], &["--fmi", fmi, "--type", "cs"]].concat());
        for distance in [0.05, 0.1, 0.125, 0.01, 0.07] {
            let mut text = "t_s,level_mm\n".to_owned();
            for row in 0..=(4.0 / distance) as usize {
                let t = row as f64 * distance;
                writeln!(text, "{t},{}", 2000.0 * (-0.8 * t).exp()).expect("a String");
            }
            folder.file("rows.csv", &text);
            folder.file(
                "rows.toml",
                "model = \"tank.fmu\"
data = { folder = \".\" }
recordings = [{ file = \"rows.csv\" }]
time = { column = \"t_s\", unit = \"s\" }
signals = { level_mm = { variable = \"x\", unit = \"mm\", sigma = 1.0 } }
free = { k = { min = 0.05, max = 5 } }
",
            );
            let words = ["evaluate", "rows.toml", "--allow-fmu", "tank.fmu", "--json"];
            let ended = succeeds(&folder, &words);
            let found: Value = serde_json::from_str(&ended.out).expect("JSON");
            let misfit = found["reduced_chi_square"].as_f64().expect("a number");
            assert!(misfit < 0.01, "FMI {fmi}, rows each {distance} s: {misfit}");
        }
    }
}

/// A run that ends before its recording is of no use, and says so.
#[test]
fn rows_after_the_end_of_a_run_are_not_zeros() {
    let folder = Scratch::new();
    let model = "model Tank
  parameter Real k = 0.8;
  Real x(start = 2, fixed = true);
equation
  der(x) = -k*x;
  when x < 0.5 then
    terminate(\"the tank is empty\");
  end when;
end Tank;
";
    folder.file("tank.mo", model);
    folder.file("rows.csv", "t,x\n0,2\n1,0.9\n2,0.4\n3,0.18\n");
    folder.file(
        "plan.toml",
        "model = \"tank.mo\"
data = { folder = \".\" }
recordings = [{ file = \"rows.csv\" }]
time = { column = \"t\", unit = \"s\" }
signals = { x = { variable = \"x\", unit = \"1\", sigma = 0.1 } }
free = { k = { min = 0.05, max = 5 } }
",
    );
    let ended = mocc(folder.path(), &["evaluate", "plan.toml"]);
    assert_eq!(ended.status, 3, "{}", ended.err);
    // ln(2/0.5)/0.8 is 1.733.
    for part in ["MO0946", "1.73", "2 s", "the tank is empty"] {
        assert!(ended.err.contains(part), "{part}: {}", ended.err);
    }
}

/// A switch and a step of a model, and of its FMUs, driven by columns: the solution consists of straight lines.
#[test]
fn columns_drive_boolean_and_integer_inputs() {
    let folder = Scratch::new();
    let model = "model Fill
  parameter Real rate = 1;
  input Boolean open(start = false);
  input Integer pumps(start = 0);
  output Real x(start = 0, fixed = true);
equation
  der(x) = if open then rate*pumps else 0;
  annotation(experiment(StopTime = 4));
end Fill;
";
    folder.file("fill.mo", model);
    let plan = "model = \"MODEL\"
data = { folder = \".\" }
recordings = [{ file = \"rows.csv\" }]
time = { column = \"t\", unit = \"s\" }
signals = { x = { variable = \"x\", unit = \"1\", sigma = 0.001 } }
free = { rate = { min = 0.1, max = 10 } }
[inputs]
open = { input = \"open\", unit = \"1\", interpolation = \"linear\" }
pumps = { input = \"pumps\", unit = \"1\", interpolation = \"hold\" }
";
    // Open from 1 s on, closed from 3 s on; two pumps, and five from 2 s on; three per pump and second.
    let mut text = "t,open,pumps,x\n".to_owned();
    for k in 0..=40 {
        let t = 0.1 * f64::from(k);
        let (open, pumps) = ((10..30).contains(&k), if k < 20 { 2 } else { 5 });
        let x = 3.0 * (2.0 * (t - 1.0).clamp(0.0, 1.0) + 5.0 * (t - 2.0).clamp(0.0, 1.0));
        writeln!(text, "{t},{},{pumps},{x}", u8::from(open)).expect("a String");
    }
    folder.file("rows.csv", &text);
    let mut models = vec!["fill.mo".to_owned()];
    if let Some(runtime) = fmu_runtime() {
        let runtime = runtime.display().to_string();
        for (fmi, kind) in [("2", "me"), ("3", "me"), ("2", "cs"), ("3", "cs")] {
            let name = format!("fill_{kind}{fmi}.fmu");
            let of = ["export", "fmu", "fill.mo", "--runtime", &runtime, "--quiet", "-o", &name];
            succeeds(&folder, &[&of[..], &["--fmi", fmi, "--type", kind]].concat());
            models.push(name);
        }
    }
    for model in models {
        folder.file("plan.toml", &plan.replace("MODEL", &model));
        let mut words = vec!["calibrate", "plan.toml", "--no-profiles", "--out", "out"];
        if model.ends_with(".fmu") {
            words.extend(["--allow-fmu", &model]);
        }
        succeeds(&folder, &words);
        let found = json(&folder, "out/calibration.json");
        let rate = found["parameters"][0]["value"].as_f64().expect("a number");
        assert!((rate - 3.0).abs() < 1e-4, "{model}: {rate}");
    }
}
