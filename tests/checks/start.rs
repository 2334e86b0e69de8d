//! `mocc simulate --explain-start`: each way in which an initial value comes about.

use serde_json::Value;

use super::door::Scratch;
use super::program::mocc;

const MODEL: &str = "model Starts
  parameter Real p = 3;
  Real fixed_one(start = p, fixed = true, unit = \"m\");
  Real assumed_one(start = 2);
  Real assumed_zero;
  Real settled(start = 9);
  Real guessed(start = 0.5);
initial equation
  der(settled) = 0;
equation
  der(fixed_one) = -fixed_one;
  der(assumed_one) = -assumed_one;
  der(assumed_zero) = 1;
  der(settled) = 4 - settled;
  guessed + exp(guessed) = fixed_one;
end Starts;
";

fn names(report: &Value, section: &str, key: &str) -> Vec<String> {
    let all = report[section].as_array().unwrap_or_else(|| panic!("{section} in {report:#}"));
    all.iter().map(|item| item[key].as_str().unwrap_or_default().to_owned()).collect()
}

#[test]
fn every_way_has_its_section() {
    let folder = Scratch::new();
    folder.file("m.mo", MODEL);
    let run = ["simulate", "m.mo", "--output", "out.csv", "--explain-start"];
    let ended = mocc(folder.path(), &[&run[..], &["--json"]].concat());
    assert_eq!(ended.status, 0, "{}", ended.err);
    let json: Value = serde_json::from_str(&ended.out).expect("JSON");
    let start = &json["start"];
    assert_eq!(names(start, "fixed", "name"), ["fixed_one"]);
    assert_eq!(start["fixed"][0]["value"], 3.0);
    assert_eq!(names(start, "assumed", "name"), ["assumed_one", "assumed_zero"]);
    assert_eq!(names(start, "assumed", "start"), ["2.0", ""]);
    assert_eq!(names(start, "initial_equations", "equation"), ["der(settled) = 0.0"]);
    assert_eq!(names(start, "states_from_equations", "name"), ["settled"]);
    assert_eq!(start["states_from_equations"][0]["value"], 4.0);
    assert_eq!(names(start, "guesses", "name"), ["guessed"]);
    // g + exp(g) = 3
    let guess = start["guesses"][0]["value"].as_f64().expect("a value");
    assert!((guess + guess.exp() - 3.0).abs() < 1e-9, "{guess}");

    let ended = mocc(folder.path(), &run);
    for line in [
        "start of Starts",
        "  fixed: start values that the model requires (1):",
        "    fixed_one = 3.0000 m  (start = p)  [m.mo:3:8]",
        "    assumed_zero = 0  (no start value, so 0)  [m.mo:5:8]",
        "    der(settled) = 0.0: determines der(settled) = 0  [m.mo:9:3]",
    ] {
        assert!(ended.out.contains(&format!("{line}\n")), "no `{line}` in\n{}", ended.out);
    }
}

#[test]
fn redundant_conditions_are_listed() {
    let folder = Scratch::new();
    folder.file(
        "p.mo",
        "model Link Real x(start = 1, fixed = true); Real v(start = 2, fixed = true); Real w(start = 4, fixed = true); \
         equation der(x) = v; der(v) = -x; w = 2*v; end Link;",
    );
    let ended = mocc(folder.path(), &["simulate", "p.mo", "--output", "o.csv", "--explain-start"]);
    assert_eq!(ended.status, 0, "{}", ended.err);
    assert!(ended.out.contains("redundant"), "{}", ended.out);
}

#[test]
fn a_start_that_fails_is_explained_before() {
    let folder = Scratch::new();
    folder.file(
        "m.mo",
        "model Fails Real x(start = 1, fixed = true); Real y(start = 0.1); equation der(x) = y; y^2 = -1 - x^2; end Fails;",
    );
    let ended = mocc(folder.path(), &["simulate", "m.mo", "--output", "o.csv", "--explain-start"]);
    assert_eq!(ended.status, 3, "{}", ended.err);
    assert!(ended.out.contains("the start could not be computed"), "{}", ended.out);
    assert!(ended.out.contains("guesses"), "{}", ended.out);
}
