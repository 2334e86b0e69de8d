//! Steady states and linear systems against closed forms.

use super::door::{Scratch, assert_close};
use super::program::{Ended, mocc};

const TANK: &str = "\
model Tank
  parameter Real k(unit = \"1/s\") = 0.5;
  parameter Real c = 3;
  input Real u(unit = \"m/s\", start = 0.25);
  output Real y = c*x + 2*u;
  Real x(unit = \"m\", start = 2, fixed = true);
equation
  der(x) = u - k*x^2;
end Tank;
";

const PENDULUM: &str = "\
model Pendulum
  parameter Real d(unit = \"1/s\") = 0.4;
  parameter Real g_l(unit = \"1/s2\") = 9;
  input Real torque(unit = \"1/s2\");
  output Real height = 1 - cos(phi);
  Real phi(unit = \"rad\", start = 0.5, fixed = true);
  Real w(unit = \"rad/s\", start = 0, fixed = true);
equation
  der(phi) = w;
  der(w) = torque - g_l*sin(phi) - d*w;
  annotation(experiment(StopTime = 2));
end Pendulum;
";

const SLIDER: &str = "\
model Slider \"A body that is pushed against a stop\"
  parameter Real f = 3;
  parameter Real c = 1e4;
  parameter Real d = 50;
  Real s(start = 0, fixed = true);
  Real v(start = 0, fixed = true);
  output Real force = if s > 0.1 then c*(s - 0.1) + d*v else 0;
equation
  der(s) = v;
  der(v) = f - force - 2*v;
end Slider;
";

fn run(model: &str, arguments: &[&str]) -> (Scratch, Ended) {
    let folder = Scratch::new();
    folder.file("model.mo", model);
    let mut all = arguments.to_vec();
    all.insert(1, "model.mo");
    all.extend(["--json", "out.json"]);
    let ended = mocc(folder.path(), &all);
    (folder, ended)
}

fn json(model: &str, arguments: &[&str]) -> serde_json::Value {
    let (folder, ended) = run(model, arguments);
    assert_eq!(ended.status, 0, "{}", ended.err);
    let text = std::fs::read_to_string(folder.path().join("out.json")).expect("the JSON");
    serde_json::from_str(&text).expect("JSON")
}

fn numbers(value: &serde_json::Value) -> Vec<f64> {
    match value {
        serde_json::Value::Array(all) => all.iter().flat_map(numbers).collect(),
        other => vec![other.as_f64().expect("a number")],
    }
}

#[test]
fn a_tank_rests_where_inflow_and_outflow_agree() {
    for (arguments, u) in [
        (&["steady"][..], 0.25),
        (&["steady", "--solve"], 0.25),
        (&["steady", "--input", "u=0.02"], 0.02),
        (&["steady", "--input", "u=0.02", "--solve"], 0.02),
    ] {
        let found = json(TANK, arguments);
        let x = f64::sqrt(u / 0.5);
        assert_close(found["states"]["x"].as_f64().expect("x"), x, 1e-10 * x);
        assert_close(found["outputs"]["y"].as_f64().expect("y"), 3.0 * x + 2.0 * u, 1e-9);
        assert_eq!(found["inputs"]["u"].as_f64(), Some(u));
        assert_close(numbers(&found["eigenvalues"])[0], -x, 1e-9);
    }
}

#[test]
fn matrices_are_the_exact_derivatives() {
    let found = json(TANK, &["linearize"]);
    assert_eq!(numbers(&found["A"]), [-2.0]);
    assert_eq!(numbers(&found["B"]), [1.0]);
    assert_eq!(numbers(&found["C"]), [3.0]);
    assert_eq!(numbers(&found["D"]), [2.0]);
    assert_eq!((numbers(&found["x"])[0], numbers(&found["dx"])[0]), (2.0, 0.25 - 2.0));
    let found = json(TANK, &["linearize", "--set", "k=2", "--output", "x", "--at", "steady"]);
    let x = f64::sqrt(0.125);
    assert_close(numbers(&found["A"])[0], -4.0 * x, 1e-9);
    assert_eq!((numbers(&found["C"]), numbers(&found["D"])), (vec![1.0], vec![0.0]));
}

/// The same model at an instant of its run: the point is that of the closed form of the pendulum's linear neighbour.
#[test]
fn an_instant_of_a_run_is_a_point() {
    let found = json(PENDULUM, &["linearize", "--at", "1.5"]);
    let (x, a) = (numbers(&found["x"]), numbers(&found["A"]));
    assert_eq!((a[0], a[1], a[3]), (0.0, 1.0, -0.4));
    assert_close(a[2], -9.0 * x[0].cos(), 1e-12);
    assert_close(numbers(&found["C"])[0], x[0].sin(), 1e-12);
    assert_close(numbers(&found["dx"])[0], x[1], 1e-12);
    assert_eq!(found["time"].as_f64(), Some(1.5));
}

#[test]
fn a_pendulum_hangs_unless_it_is_asked_to_stand() {
    let found = json(PENDULUM, &["steady"]);
    assert!(found["states"]["phi"].as_f64().expect("phi").abs() < 1e-9);
    let eigenvalues = numbers(&found["eigenvalues"]);
    assert_close(eigenvalues[0], -0.2, 1e-9);
    assert_close(eigenvalues[1], f64::sqrt(9.0 - 0.04), 1e-9);
    let upright = PENDULUM.replace("start = 0.5", "start = 3");
    let found = json(&upright, &["steady", "--solve"]);
    assert_close(found["states"]["phi"].as_f64().expect("phi"), std::f64::consts::PI, 1e-9);
    assert!(numbers(&found["eigenvalues"])[0] > 2.0);
    let found = json(&upright, &["steady"]);
    assert!(found["states"]["phi"].as_f64().expect("phi").abs() < 1e-9);
}

/// The relation is that of the state where the body rests, not of the state where it starts.
#[test]
fn contacts_close_on_the_way_to_rest() {
    for solve in [&["steady"][..], &["steady", "--set", "s.start=0.2", "--solve"]] {
        let found = json(SLIDER, solve);
        assert_close(found["states"]["s"].as_f64().expect("s"), 0.1 + 3e-4, 1e-9);
        assert_close(found["outputs"]["force"].as_f64().expect("force"), 3.0, 1e-6);
    }
    let found = json(SLIDER, &["linearize", "--at", "steady"]);
    assert_eq!(numbers(&found["A"]), [0.0, 1.0, -1e4, -52.0]);
    assert_eq!(numbers(&found["C"]), [1e4, 50.0]);
    let found = json(SLIDER, &["linearize"]);
    assert_eq!(numbers(&found["A"]), [0.0, 1.0, 0.0, -2.0]);
}

/// A valve with friction and stops: its spool rests at its stop, held by the pressure.
#[test]
fn the_valve_rests_where_a_long_run_ends() {
    let folder = Scratch::new();
    let file = format!("{}/examples/valve52.mol", env!("CARGO_MANIFEST_DIR"));
    let ended = mocc(folder.path(), &["steady", &file, "--json", "out.json"]);
    assert_eq!(ended.status, 0, "{}", ended.err);
    let text = std::fs::read_to_string(folder.path().join("out.json")).expect("the JSON");
    let found: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert!(found["states"].as_object().is_some_and(|all| all.len() > 5), "{text}");
}

#[test]
fn what_does_not_rest_is_named() {
    let model = "model M\n  Real x(start = 0, fixed = true);\n  Real y(start = 1, fixed = true);\n\
                 equation\n  der(x) = 1;\n  der(y) = -y;\nend M;\n";
    let (_, ended) = run(model, &["steady"]);
    assert_eq!(ended.status, 3, "{}", ended.out);
    assert!(ended.err.contains("MO0937") && ended.err.contains("`x` still moves"), "{}", ended.err);
    let (_, ended) = run(model, &["steady", "--solve"]);
    assert!(ended.err.contains("MO0938") && ended.err.contains("`x`"), "{}", ended.err);
    // A position that nothing holds is the nearest of many.
    let free = "model M\n  Real x(start = 3, fixed = true);\n  Real v(start = 1, fixed = true);\n\
                equation\n  der(x) = v;\n  der(v) = -2*v;\nend M;\n";
    let found = json(free, &["steady"]);
    assert_close(found["states"]["x"].as_f64().expect("x"), 3.5, 1e-5);
    assert!(found["states"]["v"].as_f64().expect("v").abs() < 1e-12);
}

/// A fast state that a slow one drives: each eigenvalue is that of its own state.
#[test]
fn eigenvalues_name_the_states_that_take_part() {
    let pair = "model Pair\n  input Real u;\n  Real slow(start = 0, fixed = true);\n  Real fast(start = 0, fixed = true);\nequation\n  der(slow) = u - slow;\n  der(fast) = 1e6*slow - 100*fast;\nend Pair;\n";
    let found = json(pair, &["linearize"]);
    assert_eq!(numbers(&found["eigenvalues"]), [-1.0, 0.0, -100.0, 0.0]);
    for (part, expected) in numbers(&found["participation"]).iter().zip([1.0, 0.0, 0.0, 1.0]) {
        assert_close(*part, expected, 1e-9);
    }
    let (_, ended) = run(pair, &["linearize"]);
    assert!(ended.out.contains("time constant 1 s; slow 100 %"), "{}", ended.out);
    let found = json(PENDULUM, &["linearize", "--at", "steady"]);
    numbers(&found["participation"]).iter().for_each(|part| assert_close(*part, 0.5, 1e-2));
}

#[test]
fn a_bode_picture_has_magnitude_and_phase() {
    let (folder, ended) = run(TANK, &["linearize", "--bode", "tank.svg"]);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    let svg = std::fs::read_to_string(folder.path().join("tank.svg")).expect("a picture");
    for text in ["magnitude in dB", "phase in degrees", "frequency in Hz", "y by u"] {
        assert!(svg.contains(text), "no {text}");
    }
    let (_, ended) = run(SLIDER, &["linearize", "--bode", "out.svg"]);
    assert!(ended.status == 2 && ended.err.contains("the model has no input"), "{}", ended.err);
}

#[test]
fn inputs_have_units_and_json_needs_no_file() {
    let found = json(TANK, &["steady", "--input", "u=2 cm/s"]);
    assert_close(found["states"]["x"].as_f64().expect("x"), 0.2, 1e-9);
    let (_, ended) = run(TANK, &["steady", "--input", "u=2 bar"]);
    assert!(ended.status == 2 && ended.err.contains("`u` is in `m/s`, not in `bar`"));
    let folder = Scratch::new();
    folder.file("model.mo", TANK);
    for arguments in [["linearize", "model.mo", "--json"], ["linearize", "--json", "model.mo"]] {
        let ended = mocc(folder.path(), &arguments);
        let found: serde_json::Value = serde_json::from_str(&ended.out).expect("JSON");
        assert_eq!(numbers(&found["A"]), [-2.0]);
    }
}

#[test]
fn wrong_requests_are_usage_errors() {
    for (arguments, said) in [
        (&["steady", "--input", "w=1"][..], "no input `w`; its inputs are: u"),
        (&["steady", "--input", "u"], "write NAME=VALUE"),
        (&["linearize", "--at", "soon"], "write a time in s, or `steady`"),
        (&["linearize", "--output", "nothing"], "no variable `nothing`"),
    ] {
        let (_, ended) = run(TANK, arguments);
        assert_eq!((ended.status, ended.err.contains(said)), (2, true), "{}", ended.err);
    }
}

#[test]
fn discrete_inputs_are_held() {
    let model = "model Rest
  input Boolean on(start = false);
  input Integer k(start = 1);
  Real x(start = 0, fixed = true);
equation
  der(x) = (if on then 3 else 0) + k - x;
end Rest;
";
    for (inputs, rest) in [
        (&[][..], 1.0),
        (&["on=true"][..], 4.0),
        (&["on=1", "k=4"], 7.0),
        (&["k=-2", "on=false"], -2.0),
    ] {
        let mut arguments = vec!["steady"];
        inputs.iter().for_each(|input| arguments.extend(["--input", input]));
        let found = json(model, &arguments);
        assert_close(found["states"]["x"].as_f64().expect("a number"), rest, 1e-9);
    }
    for (input, said) in [
        ("k=0.5", "`k` is an Integer, and 0.5 is none"),
        ("on=2", "`on` is a Boolean; give true or false, or 1 or 0"),
        ("of=1", "its inputs are: on, k"),
    ] {
        let (_, ended) = run(model, &["steady", "--input", input]);
        assert!(ended.status == 2 && ended.err.contains(said), "{}", ended.err);
    }
}
