//! `mocc diagnose` beyond pneumatics: models with connectors of their own whose recordings come from a model with an
//! effect written in other words, and folders of effects that are of no use.

use std::fmt::Write;

use serde_json::Value;

use super::door::{Case, Reading, Scratch, suite_model};
use super::program::mocc;

/// A model, what its recordings come from, and how they are made.
#[derive(Clone, Copy)]
struct Study<'a> {
    model: &'a str,
    truth: &'a str,
    /// Parameters that differ between the recordings; the last recording is for validation.
    conditions: &'a [(&'a str, &'a [f64])],
    /// Variables that are recorded, with their units and noise.
    signals: &'a [(&'a str, &'a str, f64)],
    free: &'a [&'a str],
    /// Inputs of the model, each with the variable of the truth that its column records.
    inputs: &'a [(&'a str, &'a str)],
}

impl Study<'_> {
    /// The diagnosis, and the folder it is in.
    fn diagnose(&self) -> (Value, Scratch) {
        let scratch = self.written();
        (read(&scratch, &["diagnose", "plan.toml", "--out", "out"], "diagnosis"), scratch)
    }

    /// The same where the model calls what is recorded otherwise.
    fn diagnose_as(&self, variables: &[&str]) -> (Value, Scratch) {
        let scratch = self.written();
        let mut plan = self.plan();
        for ((recorded, ..), variable) in self.signals.iter().zip(variables) {
            let named = |name: &str| format!("variable = \"{name}\"");
            plan = plan.replace(&named(recorded), &named(variable));
        }
        scratch.file("plan.toml", &plan);
        (read(&scratch, &["diagnose", "plan.toml", "--out", "out"], "diagnosis"), scratch)
    }

    /// A folder with the model, the plan and the recordings.
    fn written(&self) -> Scratch {
        let scratch = Scratch::new();
        let model = suite_model(&format!("diagnose/domains/{}", self.model));
        let truth = model.clone() + &suite_model(&format!("diagnose/domains/{}", self.truth));
        scratch.file("model.mo", &model);
        scratch.file("plan.toml", &self.plan());
        let names: Vec<&str> = self.conditions.iter().map(|(name, _)| *name).collect();
        let mut table = format!("file,split,{}\n", names.join(","));
        let count = self.conditions[0].1.len();
        for k in 0..count {
            let split = if k + 1 < count { "train" } else { "validation" };
            let values: Vec<String> =
                self.conditions.iter().map(|(_, v)| v[k].to_string()).collect();
            writeln!(table, "{k}.csv,{split},{}", values.join(",")).expect("a String");
            scratch.file(&format!("{k}.csv"), &self.recording(&truth, k));
        }
        scratch.file("table.csv", &table);
        scratch
    }

    fn plan(&self) -> String {
        let mut plan = "model = \"model.mo\"\n[data]\nfolder = \".\"\ntable = \"table.csv\"\nfile = \"file\"\n\
                        split = \"split\"\n[conditions]\n"
            .to_owned();
        // A condition of the truth alone is not one of the model.
        for (name, _) in self.conditions.iter().filter(|_| self.inputs.is_empty()) {
            writeln!(plan, "{name} = {{ parameter = \"{name}\", unit = \"1\" }}")
                .expect("a String");
        }
        plan += "[time]\ncolumn = \"t\"\nunit = \"s\"\n[signals]\n";
        for (k, (variable, unit, sigma)) in self.signals.iter().enumerate() {
            writeln!(
                plan,
                "y_{k} = {{ variable = \"{variable}\", unit = \"{unit}\", sigma = {sigma} }}"
            )
            .expect("a String");
        }
        if !self.inputs.is_empty() {
            plan += "[inputs]\n";
            for (input, recorded) in self.inputs {
                writeln!(plan, "{recorded} = {{ input = \"{input}\", unit = \"1\", interpolation = \"linear\" }}")
                    .expect("a String");
            }
        }
        plan += "[free]\n";
        self.free.iter().for_each(|name| writeln!(plan, "\"{name}\" = {{}}").expect("a String"));
        plan
    }

    /// A run of the truth with noise of the sensors.
    fn recording(&self, truth: &str, k: usize) -> String {
        let mut case = Case::text(truth).model("Truth").tolerance(1e-8);
        for (name, values) in self.conditions {
            case = case.set(format!("{name}={}", values[k]));
        }
        let run = case.run();
        let mut state = 17 + k as u64;
        let mut text = "t".to_owned();
        (0..self.signals.len()).for_each(|k| write!(text, ",y_{k}").expect("a String"));
        self.inputs.iter().for_each(|(_, recorded)| write!(text, ",{recorded}").expect("a String"));
        text.push('\n');
        // At an event there are two rows, and a sensor has only one reading.
        let is_once = |row: usize| {
            let at = |k: usize| run.time.get(k).copied();
            at(row.wrapping_sub(1)) != at(row) && at(row + 1) != at(row)
        };
        for row in (0..run.rows()).filter(|row| is_once(*row)) {
            write!(text, "{}", run.time[row]).expect("a String");
            for (variable, _, sigma) in self.signals {
                let noise = sigma * normal(&mut state);
                write!(text, ",{}", run.of(variable)[row] + noise).expect("a String");
            }
            for (_, recorded) in self.inputs {
                write!(text, ",{}", run.of(recorded)[row]).expect("a String");
            }
            text.push('\n');
        }
        text
    }
}

/// A number that is nearly normally distributed: the sum of twelve uniform ones, less its mean.
fn normal(state: &mut u64) -> f64 {
    let uniform = |_: u32| {
        *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (*state >> 11) as f64 / (1u64 << 53) as f64
    };
    (0..12).map(uniform).sum::<f64>() - 6.0
}

/// What a command writes to `out/NAME.json`.
fn read(scratch: &Scratch, arguments: &[&str], name: &str) -> Value {
    let ended = mocc(scratch.path(), arguments);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    let text = std::fs::read_to_string(scratch.path().join(format!("out/{name}.json")));
    serde_json::from_str(&text.expect("a file")).expect("JSON")
}

/// Checks that one effect was found, with its parameters, and that the amended model runs.
fn assert_found(
    found: &Value,
    scratch: &Scratch,
    class: &str,
    at: &str,
    values: &[(&str, f64, f64)],
) {
    assert_eq!(found["verdict"], "effect_found", "{found:#}");
    assert_eq!(found["effects"].as_array().map(Vec::len), Some(1), "{}", found["effects"]);
    let effect = &found["effects"][0];
    assert_eq!((&effect["component"], &effect["at"][0]), (&class.into(), &at.into()), "{effect:#}");
    for (name, value, tolerance) in values {
        let parameters = effect["parameters"].as_object().expect("an object");
        let own =
            parameters.iter().find(|(full, _)| full.ends_with(&format!(".{name}")) || full == name);
        let estimate = own.and_then(|(_, p)| p["value"].as_f64()).expect("a number");
        assert!((estimate - value).abs() < *tolerance, "{name} is {estimate}");
    }
    let chi2 = found["after"]["validation"]["chi2"].as_f64();
    assert!(chi2 < Some(1.3), "{chi2:?}");
    let amended = found["amended_model"].as_str().expect("a name");
    let ended = mocc(&scratch.path().join("out"), &["simulate", amended]);
    assert_eq!(ended.status, 0, "{}", ended.err);
}

/// A motor in its own file, with connectors without units: only their names tell what they are.
#[test]
fn a_fan_is_found_on_a_motor_with_connectors_of_its_own() {
    let study = Study {
        model: "fan",
        truth: "fan_truth",
        conditions: &[("U", &[6.0, 12.0, 18.0, 9.0])],
        signals: &[("rotor.w", "rad/s", 0.4), ("armature.i", "A", 0.02)],
        free: &["rotor.J", "armature.k", "bearing.d"],
        inputs: &[],
    };
    let (found, scratch) = study.diagnose();
    assert_found(&found, &scratch, "Effects.FanDrag", "rotor", &[("k", 2.4e-5, 3e-7)]);
    assert_eq!(found["balances"][0]["inflow"], "Effects.UnknownTorque", "{}", found["balances"][0]);
    let amended = found["amended_model"].as_str().expect("a name");
    let text = std::fs::read_to_string(scratch.path().join("out").join(amended)).expect("a model");
    let (_, added) = text.split_once("// Found by mocc diagnose:").expect("an addition");
    for line in ["FlangeForShaft at_rotor_shaft;", "connect(at_rotor_shaft.of_model, rotor.shaft);"]
    {
        assert!(added.contains(line), "{added}");
    }
}

/// `tau = k w |w|^0.6`: a law between those of a bearing and a fan becomes a formula with that power. The damping of the
/// bearing is known: one that varied with the speed would be the same law.
#[test]
fn a_law_between_two_of_the_library_becomes_a_formula() {
    let study = Study {
        model: "fan",
        truth: "stirrer_truth",
        conditions: &[("U", &[6.0, 12.0, 18.0, 9.0])],
        signals: &[("rotor.w", "rad/s", 0.1), ("armature.i", "A", 0.005)],
        free: &["rotor.J", "armature.k"],
        inputs: &[],
    };
    let (found, scratch) = study.diagnose();
    let (class, exponent) = ("Effects.FreeTorqueOverSpeed", ("exponent", 1.6, 0.1));
    assert_found(&found, &scratch, class, "rotor", &[exponent]);
}

/// Dry friction that is smoothed is one effect with its own name.
#[test]
fn smoothed_dry_friction_is_found() {
    let study = Study {
        model: "fan",
        truth: "smooth_brake_truth",
        conditions: &[("U", &[6.0, 12.0, 18.0, 9.0])],
        signals: &[("rotor.w", "rad/s", 0.1), ("armature.i", "A", 0.005)],
        free: &["rotor.J", "armature.k", "bearing.d"],
        inputs: &[],
    };
    let (found, scratch) = study.diagnose();
    let values = [("M", 0.04, 1e-3), ("w_0", 5.0, 0.5)];
    assert_found(&found, &scratch, "Effects.SmoothBearingFriction", "rotor", &values);
}

/// A leak between two tanks is a term of both equations over the difference of the levels, which has no name.
#[test]
fn an_exchange_between_two_states_is_found() {
    let study = Study {
        model: "tanks",
        truth: "tanks_truth",
        conditions: &[("h_0", &[2.0, 4.0, 1.0, 3.0])],
        signals: &[("h_1", "1", 0.005), ("h_2", "1", 0.005)],
        free: &["c"],
        inputs: &[],
    };
    let (found, _scratch) = study.diagnose();
    let effects = found["effects"].as_array().expect("a list");
    assert_eq!((&found["verdict"], effects.len()), (&"effect_found".into(), 2), "{found:#}");
    for effect in effects {
        assert_eq!(effect["component"], "Effects.LinearTerm");
        assert_eq!(effect["law"], "a (h_1 - h_2)");
        assert_eq!(effect["over"], serde_json::json!(["h_1", "h_2"]));
        let parameters = effect["parameters"].as_object().expect("an object");
        let a = parameters.values().next().and_then(|p| p["value"].as_f64()).expect("a number");
        let expected = if effect["at"][0] == "der(h_1)" { -0.01 } else { 0.01 };
        assert!((a - expected).abs() < 2e-4, "{effect:#}");
    }
}

/// Connectors with other names, whose units tell what they are.
#[test]
fn a_diode_is_found_in_a_circuit_with_connectors_of_its_own() {
    let study = Study {
        model: "rectifier",
        truth: "rectifier_truth",
        conditions: &[("U", &[5.0, 10.0, 12.0, 8.0]), ("f", &[5.0, 8.0, 4.0, 6.0])],
        signals: &[("store.v", "V", 0.02)],
        free: &["line.R", "store.C"],
        inputs: &[],
    };
    let (found, scratch) = study.diagnose();
    let values = [("G", 1.0 / 110.0, 2e-4), ("V", 0.7, 0.02)];
    assert_found(&found, &scratch, "Effects.DiodeDrop", "line", &values);
}

/// Slip rings lose a voltage in series with a winding whose current is measured: the sensor reads what flows through
/// both, also in the amended model.
#[test]
fn a_lost_voltage_is_found_where_the_current_is_measured() {
    let study = Study {
        model: "slip_rings",
        truth: "slip_rings_truth",
        conditions: &[("U", &[5.0, 10.0, 8.0, 6.0]), ("f", &[0.5, 1.0, 0.8, 0.6])],
        signals: &[("winding.i", "A", 0.01), ("load.v", "V", 0.02)],
        free: &["winding.R", "load.R"],
        inputs: &[],
    };
    let (found, scratch) = study.diagnose();
    let values = [("G", 0.8, 0.02), ("V", 0.8, 0.02)];
    assert_found(&found, &scratch, "Effects.VoltageDrop", "winding", &values);
    let amended = found["amended_model"].as_str().expect("a model");
    let text = std::fs::read_to_string(scratch.path().join("out").join(amended)).expect("a model");
    assert!(text.contains("reading_of_y_0(unit = \"A\") = winding.i + voltage_drop.p.i"), "{text}");
    assert!(text.contains("measured = \"y_0=reading_of_y_0\""), "{text}");
}

/// The closed form: a = 0.004 R i_max^2/0.5, tau = 40/0.5 s.
#[test]
fn a_resistance_that_heats_is_found() {
    let study = Study {
        model: "coil",
        truth: "coil_truth",
        conditions: &[("U", &[5.0, 10.0, 14.0, 8.0])],
        signals: &[("i", "A", 0.005)],
        free: &["R"],
        inputs: &[],
    };
    let (found, scratch) = study.diagnose();
    assert_found(&found, &scratch, "parameter", "R", &[("tau", 80.0, 2.0)]);
    assert_eq!(found["effects"][0]["over"][0], "i");
}

/// A loss to surroundings that the model does not have, from an element of an array of components.
#[test]
fn a_heat_loss_is_found_at_an_element_of_an_array() {
    let study = Study {
        model: "plates",
        truth: "plates_truth",
        conditions: &[("P", &[20.0, 40.0, 60.0, 30.0]), ("T_s", &[300.0, 310.0, 295.0, 305.0])],
        signals: &[("plate[1].T", "K", 0.1), ("plate[2].T", "K", 0.1)],
        free: &["bridge.G"],
        inputs: &[],
    };
    let (found, scratch) = study.diagnose();
    let values = [("G", 0.12, 2e-3), ("T_0", 288.0, 1.0)];
    assert_found(&found, &scratch, "Effects.HeatLoss", "plate[2]", &values);
}

/// A vessel whose equations lose no heat: `12000 der(T_2) = ... - 6 (T_2 - 288)`.
#[test]
fn a_heat_loss_is_found_as_a_term_of_an_equation() {
    let study = Study {
        model: "kettle",
        truth: "kettle_truth",
        conditions: &[("P", &[200.0, 400.0, 600.0, 300.0])],
        signals: &[("T_1", "K", 0.05), ("T_2", "K", 0.05)],
        free: &["C_1", "C_2", "G"],
        inputs: &[],
    };
    let (found, scratch) = study.diagnose();
    let values = [("a", 6.0, 0.1), ("x_0", 288.0, 0.5)];
    assert_found(&found, &scratch, "Effects.ExchangeTerm", "der(T_2)", &values);
}

/// The loss depends on the difference of a state and an input, as the model's own equation writes it: neither of the two tells.
#[test]
fn a_loss_over_the_difference_to_an_input_is_found() {
    let study = Study {
        model: "collector",
        truth: "collector_truth",
        conditions: &[("A", &[1000.0, 700.0, 1200.0, 850.0])],
        signals: &[("T", "K", 0.1)],
        free: &["U", "C"],
        inputs: &[("sun", "sun"), ("T_air", "air")],
    };
    let (found, scratch) = study.diagnose();
    assert_found(&found, &scratch, "Effects.QuadraticTerm", "der(T)", &[("a", -0.05, 0.003)]);
    assert_eq!(found["effects"][0]["over"], serde_json::json!(["T", "T_air"]));
}

/// Noise with a correlation of 0.85 from one row to the next: hundreds of candidates follow its waves, and none is supported by
/// as many samples as are independent.
#[test]
fn coloured_noise_is_no_effect() {
    let (written, declared) = (1e-9, 0.1);
    let study = Study {
        model: "kettle",
        truth: "kettle_itself",
        conditions: &[("P", &[200.0, 400.0, 600.0, 300.0])],
        signals: &[("T_1", "K", written), ("T_2", "K", written)],
        free: &["C_1", "C_2", "G"],
        inputs: &[],
    };
    for seed in 1..=6 {
        let scratch = study.written();
        let sigma = format!("sigma = {written}");
        scratch.file("plan.toml", &study.plan().replace(&sigma, &format!("sigma = {declared}")));
        let mut state = 1000 * seed;
        for k in 0..4 {
            let file = format!("{k}.csv");
            let text = std::fs::read_to_string(scratch.path().join(&file)).expect("a recording");
            scratch.file(&file, &with_coloured_noise(&text, declared, 0.85, &mut state));
        }
        let found = read(&scratch, &["diagnose", "plan.toml", "--out", "out"], "diagnosis");
        assert_ne!(found["verdict"], "effect_found", "seed {seed}: {found:#}");
    }
}

/// All columns but that of the time, each with autoregressive noise of the first order of its own.
fn with_coloured_noise(text: &str, sigma: f64, correlation: f64, state: &mut u64) -> String {
    let mut lines = text.lines();
    let mut out = lines.next().expect("a head").to_owned() + "\n";
    let mut noise = vec![0.0; out.matches(',').count()];
    let own = sigma * (1.0 - correlation.powi(2)).sqrt();
    for line in lines {
        let (time, values) = line.split_once(',').expect("columns");
        out.push_str(time);
        for (noise, value) in noise.iter_mut().zip(values.split(',')) {
            *noise = correlation * *noise + own * normal(state);
            let value: f64 = value.parse().expect("a number");
            write!(out, ",{}", value + *noise).expect("a String");
        }
        out.push('\n');
    }
    out
}

/// Every recording starts elsewhere, which no effect explains: the summary and the file name the state.
#[test]
fn starts_that_differ_between_recordings_are_named() {
    let study = Study {
        model: "bath",
        truth: "bath_truth",
        conditions: &[("T_0", &[302.0, 290.0, 311.0, 297.0])],
        signals: &[("T", "K", 0.05)],
        free: &["C", "G"],
        inputs: &[],
    };
    let (found, _scratch) = study.diagnose();
    assert_eq!(found["verdict"], "unexplained", "{}", found["effects"]);
    let starts = &found["separate_starts"];
    assert_eq!(starts["states"], serde_json::json!(["T"]), "{starts}");
    assert!(starts["validation"].as_f64() < Some(1.3), "{starts}");
}

/// A conductor of 0.35 W/K between two bodies that nothing else connects. The first is named after the heater on it.
#[test]
fn a_strap_between_distant_bodies_is_found() {
    let study = Study {
        model: "row",
        truth: "row_truth",
        conditions: &[("P", &[10.0, 20.0, 30.0, 15.0])],
        signals: &[("body_1.T", "K", 0.05), ("body_2.T", "K", 0.05), ("body_3.T", "K", 0.05)],
        free: &["joint_1.G", "joint_2.G", "foot.G"],
        inputs: &[],
    };
    let (found, scratch) = study.diagnose();
    assert_found(&found, &scratch, "Effects.HeatLeak", "heater", &[("G", 0.35, 5e-3)]);
    assert_eq!(found["effects"][0]["at"], serde_json::json!(["heater", "body_3"]));
    let sentence = "Heat leaks past the wall between heater and body_3.";
    assert_eq!(found["effects"][0]["explains"], sentence);
}

/// A store behind a conductance of 0.3 W/K: it warms with 60/0.3 s. It is found where the heater meets the plate.
#[test]
fn a_second_heat_store_is_found() {
    let study = Study {
        model: "plates",
        truth: "holder_truth",
        conditions: &[("P", &[20.0, 40.0, 60.0, 30.0])],
        signals: &[("plate[1].T", "K", 0.1), ("plate[2].T", "K", 0.1)],
        free: &["bridge.G"],
        inputs: &[],
    };
    let (found, scratch) = study.diagnose();
    let values = [("C", 60.0, 3.0), ("tau", 200.0, 10.0)];
    assert_found(&found, &scratch, "Effects.SecondHeatStore", "heater", &values);
}

/// `G = 0.4 (1 + 0.01 (T - 290))`: the products of the found parameters are those of the truth, whatever range of
/// temperatures the factor is written over.
#[test]
fn a_parameter_that_varies_is_found() {
    let study = Study {
        model: "cooling",
        truth: "cooling_truth",
        conditions: &[("P", &[10.0, 40.0, 60.0, 30.0])],
        signals: &[("T", "K", 0.1)],
        free: &["G"],
        inputs: &[],
    };
    let (found, scratch) = study.diagnose();
    assert_found(&found, &scratch, "parameter", "G", &[]);
    let effect = &found["effects"][0];
    assert_eq!(
        (&effect["over"][0], effect["over"].as_array().map(Vec::len)),
        (&"T".into(), Some(1))
    );
    let law = effect["law"].as_str().expect("a law");
    assert!(law.starts_with("1 + a (T - 290)/("), "{effect:#}");
    let amended = found["amended_model"].as_str().expect("a name");
    let ended = mocc(&scratch.path().join("out"), &["flatten", amended]);
    let value = |name: &str| -> f64 {
        let (_, rest) = ended.out.split_once(&format!("Real {name} = ")).expect("a parameter");
        rest.split([';', ' ']).next().and_then(|v| v.parse().ok()).expect("a number")
    };
    let [a, low, high] = ["a", "x_lo", "x_hi"].map(|p| value(&format!("'linear_variation.{p}'")));
    let at = |t: f64| value("G") * (1.0 + a * (t - low) / (high - low));
    for t in [290.0, 340.0] {
        let truth = 0.4 * (1.0 + 0.01 * (t - 290.0));
        assert!((at(t) - truth).abs() < 0.01 * truth, "{} is not {truth}", at(t));
    }
}

/// The constant of a motor, which the plan takes for known: it scales the torque and the voltage.
#[test]
fn a_wrong_value_in_the_model_is_found() {
    let study = Study {
        model: "fan",
        truth: "motor_constant_truth",
        conditions: &[("U", &[6.0, 12.0, 4.0, 8.0])],
        signals: &[("rotor.w", "1", 0.5), ("armature.i", "1", 0.02)],
        free: &["rotor.J", "armature.R", "bearing.d"],
        inputs: &[],
    };
    let (found, scratch) = study.diagnose();
    let values = [("a", 1.25_f64.ln(), 0.01)];
    assert_found(&found, &scratch, "parameter", "armature.k", &values);
    assert_eq!(found["effects"][0]["over"], serde_json::json!([]));
    let amended = found["amended_model"].as_str().expect("a name");
    let text = std::fs::read_to_string(scratch.path().join("out").join(amended)).expect("a model");
    let (before, _) = text.split_once(", instead of 0.08").expect("the value of the model");
    let (_, value) = before.rsplit_once("k = ").expect("the new value");
    let (value, _) = value.split_once(" //").expect("its error");
    let value: f64 = value.trim_end_matches(',').parse().expect("a number");
    assert!((value - 0.1).abs() < 1e-3, "{text}");
}

/// An angle of release whose scale is off by the same amount in all recordings.
#[test]
fn a_wrong_start_is_found() {
    let study = Study {
        model: "release",
        truth: "release_truth",
        conditions: &[("phi_0", &[0.3, 0.6, -0.5, 0.9, 0.45])],
        signals: &[("phi", "rad", 0.004)],
        free: &["g_l", "d"],
        inputs: &[],
    };
    let (found, scratch) = study.diagnose();
    assert_found(&found, &scratch, "Effects.OtherStart", "phi", &[("d", 0.02, 0.001)]);
}

/// The weight of an eccentric mass in a model without connectors: a term of the equation of its rate.
#[test]
fn a_term_that_an_equation_lacks_is_found() {
    let study = Study {
        model: "wheel",
        truth: "wheel_truth",
        conditions: &[("M", &[0.06, 0.1, -0.08, 0.12])],
        signals: &[("phi", "rad", 0.01)],
        free: &["J", "d"],
        inputs: &[],
    };
    let (found, scratch) = study.diagnose();
    let values = [("A", -0.05, 1e-3), ("B", 0.0, 1e-3)];
    assert_found(&found, &scratch, "Effects.PeriodicTerm", "der(w)", &values);
    assert_eq!(found["effects"][0]["over"], serde_json::json!(["phi"]));
    assert_eq!(found["effects"][0]["law"], "A sin(phi) + B cos(phi)");
    let amended = found["amended_model"].as_str().expect("a name");
    let text = std::fs::read_to_string(scratch.path().join("out").join(amended)).expect("a model");
    assert!(text.contains("adds = \"der(w) = periodic_term.term\""), "{text}");
}

/// A term has the sign that it has beside the rate, however the equation is written.
#[test]
fn a_quadratic_drag_is_found_in_an_equation() {
    let study = Study {
        model: "cart",
        truth: "cart_truth",
        conditions: &[("v_0", &[1.0, 3.0, 0.5, 2.0])],
        signals: &[("v", "m/s", 0.01)],
        free: &["d"],
        inputs: &[],
    };
    let (found, scratch) = study.diagnose();
    assert_found(&found, &scratch, "Effects.QuadraticTerm", "der(v)", &[("a", -0.3, 0.01)]);
}

/// A law that a parameter of the model selects, with a parameter of its own that the model has at another value.
#[test]
fn another_law_of_the_model_is_found() {
    let study = Study {
        model: "sled",
        truth: "sled_truth",
        conditions: &[("F", &[20.0, 50.0, 80.0, 40.0])],
        signals: &[("v", "m/s", 0.02)],
        free: &["m", "k"],
        inputs: &[],
    };
    let (found, scratch) = study.diagnose();
    assert_found(&found, &scratch, "Drag.Quadratic", "drag", &[("c", 0.7, 0.01)]);
}

/// A law that stands in the place of a replaceable class.
#[test]
fn a_class_that_fits_a_replaceable_one_is_found() {
    let study = Study {
        model: "sledge",
        truth: "sledge_truth",
        conditions: &[("F", &[20.0, 50.0, 80.0, 40.0])],
        signals: &[("v", "m/s", 0.02)],
        free: &["m", "brake.k"],
        inputs: &[],
    };
    let (found, scratch) = study.diagnose();
    assert_found(&found, &scratch, "Quadratic", "brake", &[("c", 0.7, 0.01)]);
}

/// A heating element with a time constant of 12 s between the recorded power and the oven.
#[test]
fn an_actuator_with_a_lag_is_found() {
    let study = Study {
        model: "oven",
        truth: "oven_truth",
        conditions: &[("A", &[20.0, 50.0, 80.0, 40.0])],
        signals: &[("T", "K", 0.05)],
        free: &["G", "C"],
        inputs: &[("P", "asked")],
    };
    let (found, scratch) = study.diagnose();
    assert_found(&found, &scratch, "Effects.ActuatorLag", "P", &[("T", 12.0, 0.3)]);
}

/// A heating that acts 7 s after it is asked. In a linear model a sensor that reads late would do the same.
#[test]
fn an_actuator_with_a_dead_time_is_found() {
    let study = Study {
        model: "oven",
        truth: "late_truth",
        conditions: &[("A", &[20.0, 50.0, 80.0, 40.0])],
        signals: &[("T", "K", 0.05)],
        free: &["G", "C"],
        inputs: &[("P", "asked")],
    };
    let (found, scratch) = study.diagnose();
    assert_found(&found, &scratch, "Effects.ActuatorDelay", "P", &[("t_d", 7.0, 0.1)]);
}

/// An amplifier that gives no more than 30 W.
#[test]
fn an_actuator_that_saturates_is_found() {
    let study = Study {
        model: "oven",
        truth: "amplifier_truth",
        conditions: &[("A", &[20.0, 50.0, 60.0, 40.0])],
        signals: &[("T", "K", 0.05)],
        free: &["G", "C"],
        inputs: &[("P", "asked")],
    };
    let (found, scratch) = study.diagnose();
    let values = [("y_max", 30.0, 0.3), ("a", 1.0, 0.01)];
    assert_found(&found, &scratch, "Effects.ActuatorLimit", "P", &values);
}

/// `i = 5 mA (v/3 V)^5`: no law of the library, so the curve over the voltage becomes a formula. The amplitude is that at
/// the scale of the formula.
#[test]
fn a_law_that_the_library_lacks_becomes_a_formula() {
    let study = Study {
        model: "rectifier",
        truth: "varistor_truth",
        conditions: &[("U", &[5.0, 10.0, 12.0, 8.0]), ("f", &[5.0, 8.0, 4.0, 6.0])],
        signals: &[("store.v", "V", 0.02)],
        free: &["line.R", "store.C"],
        inputs: &[],
    };
    let (found, scratch) = study.diagnose();
    assert_found(
        &found,
        &scratch,
        "Effects.FreeCurrentOverVoltage",
        "store",
        &[("exponent", 5.0, 0.3)],
    );
    let effect = &found["effects"][0];
    assert_eq!(effect["law"], "i = A (v/5)^exponent", "{effect:#}");
    let amended = found["amended_model"].as_str().expect("a name");
    let text = std::fs::read_to_string(scratch.path().join("out").join(amended)).expect("a model");
    assert!(text.contains("i = A*Effects.regularPower(((v - v_m)/v_0), exponent);"), "{text}");
}

/// One law in all components of a class, each over its own state: `k h^0.2` in place of `k`.
#[test]
fn components_of_one_class_share_a_law() {
    let study = Study {
        model: "cascade",
        truth: "cascade_truth",
        conditions: &[("h_0", &[1.0, 2.0, 0.5, 1.5]), ("f", &[1.0, 0.5, 2.0, 1.5])],
        signals: &[("h_1", "1", 0.002), ("h_2", "1", 0.002)],
        free: &["k_1", "k_2"],
        inputs: &[],
    };
    let (found, _scratch) = study.diagnose_as(&["upper.h", "lower.h"]);
    assert_eq!(found["verdict"], "effect_found", "{found:#}");
    assert_eq!(found["effects"].as_array().map(Vec::len), Some(1), "{found:#}");
    let effect = &found["effects"][0];
    assert_eq!(effect["at"], serde_json::json!(["k_1", "k_2"]), "{effect:#}");
    assert_eq!(effect["over"], serde_json::json!(["upper.h", "lower.h"]), "{effect:#}");
    let exponents = effect["parameters"].as_object().expect("an object");
    assert_eq!(exponents.len(), 2, "{effect:#}");
    for exponent in exponents.values() {
        let value = exponent["value"].as_f64().expect("a number");
        assert!((value - 0.2).abs() < 0.01, "{effect:#}");
    }
}

/// A time constant of 20 s for the rise and of 60 s for the fall: 40 s with half a difference of 0.5.
#[test]
fn a_time_constant_differs_between_rise_and_fall() {
    let study = Study {
        model: "kiln",
        truth: "kiln_truth",
        conditions: &[("f", &[1.0, 0.5, 2.0, 1.5])],
        signals: &[("y", "1", 0.005)],
        free: &["tau"],
        inputs: &[],
    };
    let (found, scratch) = study.diagnose();
    assert_found(&found, &scratch, "parameter", "tau", &[("a", -0.5, 0.01)]);
    assert_eq!(found["effects"][0]["over"], serde_json::json!(["der(y)"]), "{found:#}");
}

/// A resistance that is half as large again from the fourth recording on.
#[test]
fn a_part_that_was_exchanged_is_found() {
    let study = Study {
        model: "filter",
        truth: "filter_truth",
        conditions: &[
            ("R", &[2.0, 2.0, 2.0, 3.0, 3.0, 3.0]),
            ("f", &[1.0, 0.5, 2.0, 1.5, 0.8, 1.2]),
        ],
        signals: &[("p", "1", 0.01)],
        free: &["R", "C"],
        inputs: &[("q", "q")],
    };
    let (found, scratch) = study.diagnose();
    assert_found(&found, &scratch, "parameter", "R", &[("a", 0.5, 0.01)]);
    let effect = &found["effects"][0];
    assert_eq!(effect["law"], "if recording_number > 3.5 then 1 + a else 1", "{effect:#}");
}

/// The error that the next experiment promises is the one that a fit with its recording has, and smaller than that with
/// a recording under average conditions.
#[test]
fn the_next_experiment_keeps_its_promise() {
    let study = Study {
        model: "fan",
        truth: "fan_itself",
        conditions: &[("U", &[6.0, 12.0, 18.0, 9.0])],
        signals: &[("rotor.w", "rad/s", 0.4), ("armature.i", "A", 0.02)],
        free: &["rotor.J", "armature.k", "bearing.d"],
        inputs: &[],
    };
    let diagnose = ["diagnose", "plan.toml", "--next", "--out", "out"];
    let found = read(&study.written(), &diagnose, "diagnosis");
    assert_eq!(found["verdict"], "complete");
    let narrows = &found["next"]["narrows"];
    let number = |v: &Value| v.as_f64().expect("a number");
    let name = narrows["parameter"].as_str().expect("a name");
    let error_with = |u: Option<f64>| {
        let voltages: Vec<f64> = [6.0, 12.0, 18.0].into_iter().chain(u).chain([9.0]).collect();
        let conditions = [("U", voltages.as_slice())];
        let written = Study { conditions: &conditions, ..study }.written();
        let calibrate = ["calibrate", "plan.toml", "--no-profiles", "--out", "out"];
        let fit = read(&written, &calibrate, "calibration");
        let all = fit["parameters"].as_array().expect("a list");
        let own = all.iter().find(|p| p["name"] == name).expect("the parameter");
        number(&own["standard_error"])
    };
    let next = number(&found["next"]["conditions"]["U"]["value"]);
    let near = |a: f64, b: f64, share: f64| assert!((a - b).abs() < share * b, "{a} is not {b}");
    near(number(&narrows["stderr"]), error_with(None), 0.02);
    near(number(&narrows["expected"]), error_with(Some(next)), 0.05);
    assert!(error_with(Some(next)) < error_with(Some(8.0)), "{narrows}");
}

/// What is said of a folder of effects.
fn said_of(folder: &str, files: &[(&str, &str)]) -> String {
    let scratch = Scratch::new();
    scratch.file("model.mo", &suite_model("diagnose/domains/plates"));
    let plan = "model = \"model.mo\"\ndata = { folder = \".\" }\nrecordings = [{ file = \"run.csv\" }]\n\
                time = { column = \"t\", unit = \"s\" }\n\
                signals = { y = { variable = \"plate[1].T\", unit = \"K\", sigma = 0.1 } }\n\
                free = { \"bridge.G\" = {} }\n";
    scratch.file("plan.toml", plan);
    let run = Case::text(&suite_model("diagnose/domains/plates")).run();
    let mut text = "t,y\n".to_owned();
    for (row, temperature) in run.of("plate[1].T").iter().enumerate().step_by(5) {
        let noise = if row % 2 == 0 { 0.1 } else { -0.1 };
        writeln!(text, "{},{}", run.time[row], temperature + noise).expect("a String");
    }
    scratch.file("run.csv", &text);
    for (name, text) in files {
        scratch.file(name, text);
    }
    let ended =
        mocc(scratch.path(), &["diagnose", "plan.toml", "--out", "out", "--effects", folder]);
    format!("status {}\n{}", ended.status, ended.err)
}

#[test]
fn a_folder_of_effects_that_is_of_no_use_is_reported() {
    let leak = &suite_model("diagnose/domains/leak");
    let plain = &leak.replace("annotation", "annotation(Documentation(info = \"\")); //");
    let cases = [
        ("no such folder", said_of("effects", &[])),
        ("a file", said_of("plan.toml", &[])),
        ("a package itself", said_of("own", &[("own/package.mo", "package Own end Own;")])),
        ("no files of Modelica", said_of("own", &[("own/notes.txt", "later")])),
        ("no annotation", said_of("own", &[("own/Leak.mo", plain)])),
        ("no connector of this kind", said_of("own", &[("own/Leak.mo", leak)])),
        (
            "in a package",
            said_of(
                "own",
                &[
                    ("own/Mine/package.mo", "package Mine \"Effects\" end Mine;"),
                    ("own/Mine/Leak.mo", &format!("within Mine;\n{leak}")),
                ],
            ),
        ),
    ];
    let said: Vec<String> = cases.iter().map(|(what, said)| format!("## {what}\n{said}")).collect();
    insta::assert_snapshot!(said.join("\n"));
}

/// `k_T = 0.95 (1 + 0.03/z^2)`: a curve over the height becomes an inverse power before a second law makes up for its knots.
#[test]
fn a_rotor_near_the_ground_follows_an_inverse_square() {
    let study = Study {
        model: "hover",
        truth: "hover_truth",
        conditions: &[("z_1", &[1.0, 2.0, 0.5, 1.5, 0.3]), ("z_2", &[0.3, 0.4, 2.0, 0.5, 0.8])],
        signals: &[("z", "m", 0.005), ("F", "N", 0.02)],
        free: &["k_T"],
        inputs: &[],
    };
    let (found, scratch) = study.diagnose();
    assert_found(&found, &scratch, "parameter", "k_T", &[("exponent", 2.0, 0.1)]);
    assert_eq!(found["effects"][0]["over"], serde_json::json!(["z"]), "{found:#}");
}

/// `exp(-((T - 25)/8)^2)` relative to the middle of the temperatures, 22.5 +- 22.5 degrees: `b = -(22.5/8)^2`.
#[test]
fn growth_has_an_optimum() {
    let study = Study {
        model: "culture",
        truth: "culture_truth",
        conditions: &[("T_m", &[10.0, 20.0, 35.0, 28.0])],
        signals: &[("X", "1", 0.01)],
        free: &["mu"],
        inputs: &[],
    };
    let (found, scratch) = study.diagnose();
    assert_found(&found, &scratch, "parameter", "mu", &[]);
    let effect = &found["effects"][0];
    assert_eq!(effect["over"], serde_json::json!(["T"]), "{effect:#}");
    let law = effect["law"].as_str().expect("a law");
    assert!(law.starts_with("exp(a u + b u^2)"), "{effect:#}");
    let of = |name: &str| effect["parameters"][name]["value"].as_f64().expect("a number");
    // The place of the optimum and the width, in units of half the range of the temperatures.
    let (place, width) = (-of("a") / (2.0 * of("b")), (-1.0 / of("b")).sqrt());
    assert!(((25.0 - 22.5) / 22.5 - place).abs() < 0.02, "{effect:#}");
    assert!((8.0 / 22.5 - width).abs() < 0.02, "{effect:#}");
}

/// Michaelis and Menten's law, which dry friction with a rounded jump resembles.
#[test]
fn an_elimination_that_saturates_is_found() {
    let study = Study {
        model: "elimination",
        truth: "elimination_truth",
        conditions: &[("dose", &[5.0, 60.0, 20.0, 35.0])],
        signals: &[("C", "1", 0.05)],
        free: &["k"],
        inputs: &[],
    };
    let (found, scratch) = study.diagnose();
    let values = [("A", -1.6, 0.1), ("K", 1.5, 0.3)];
    assert_found(&found, &scratch, "Effects.SaturatingTerm", "der(C)", &values);
}

/// A body that is held at a narrow place, where the model goes on: along its free runs the friction there promises little.
#[test]
fn friction_at_a_narrow_place_is_found_by_runs_that_follow_the_recordings() {
    let study = Study {
        model: "slide",
        truth: "slide_truth",
        conditions: &[("F", &[15.0, 18.0, 21.0, 17.0])],
        signals: &[("body.s", "m", 2e-5)],
        free: &["m", "d", "c"],
        inputs: &[],
    };
    let (found, scratch) = study.diagnose();
    assert!(found["before"]["train"]["chi2"].as_f64() > Some(200.0), "{}", found["before"]);
    // The body comes to rest before the middle of the place, so that the height there is known least.
    let values = [("s_0", 9e-3, 3e-4), ("w", 0.6e-3, 1.2e-4)];
    assert_found(&found, &scratch, "Effects.PositionFriction", "body", &values);
}
