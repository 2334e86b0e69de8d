//! `mocc check`: all problems of a file, and nothing else.

use std::path::Path;

use super::door::{Scratch, suite_model};
use super::program::mocc;

const SEVERAL: &str = "check/classes/several_problems";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn the_same_as_json() {
    let folder = Scratch::new();
    folder.file("several.mo", &suite_model(SEVERAL));
    let ended = mocc(folder.path(), &["check", "several.mo", "--json"]);
    assert_eq!((ended.status, ended.err.as_str()), (1, ""));
    let all: serde_json::Value = serde_json::from_str(&ended.out).expect("JSON");
    let all = all.as_array().expect("a list");
    let found: Vec<(&str, u64)> = all
        .iter()
        .map(|p| (p["code"].as_str().expect("a code"), p["line"].as_u64().expect("a line")))
        .collect();
    assert!(found.is_sorted_by_key(|(_, line)| *line), "{found:?}");
    assert_eq!(
        found[..4],
        [("MO0234", 16), ("MO0234", 22), ("MO0202", 31), ("MO0202", 32)],
        "{found:?}"
    );
    let undeclared = &all[2];
    assert_eq!(undeclared["file"], "several.mo");
    assert_eq!(undeclared["column"], 14);
    assert_eq!(undeclared["end"], serde_json::json!({ "line": 31, "column": 15 }));
    assert_eq!(undeclared["severity"], "error");
    for key in ["message", "help", "notes", "label", "also"] {
        assert!(undeclared.get(key).is_some(), "{key}");
    }
}

#[test]
fn examples_and_library_have_no_problems() {
    let mut files = Vec::new();
    for folder in
        ["examples", "examples/evolution", "lib/Translational", "lib/Pneumatics", "lib/Signals"]
    {
        for entry in std::fs::read_dir(root().join(folder)).expect(folder).flatten() {
            let path = entry.path();
            if path.extension().is_some_and(|e| e == "mol" || e == "mo") {
                files.push(format!("{folder}/{}", entry.file_name().to_string_lossy()));
            }
        }
    }
    files.sort();
    assert!(files.len() > 30);
    for file in files {
        let ended = mocc(root(), &["check", &file, "--json"]);
        let all: serde_json::Value = serde_json::from_str(&ended.out).expect("JSON");
        let errors: Vec<_> =
            all.as_array().expect("a list").iter().filter(|p| p["severity"] == "error").collect();
        assert!(ended.status == 0 && errors.is_empty(), "{file}: {errors:#?}");
    }
}

#[test]
fn one_model_and_what_is_not_there() {
    let folder = Scratch::new();
    folder.file("several.mo", &suite_model(SEVERAL));
    let one = mocc(folder.path(), &["check", "several.mo", "--model", "Several.Resistor"]);
    assert_eq!(one.status, 0, "{}", one.err);
    let none = mocc(folder.path(), &["check", "several.mo", "--model", "Several.Resistr"]);
    assert_eq!(none.status, 2);
    assert!(none.err.contains("MO0104"), "{}", none.err);
    assert_eq!(mocc(root(), &["check", "nowhere.mo"]).status, 2);
}

#[test]
fn units_that_do_not_match_are_warnings_or_errors() {
    let folder = Scratch::new();
    folder.file("units.mo", &suite_model("check/units/equations_whose_units_differ"));
    let ended = mocc(folder.path(), &["check", "units.mo"]);
    assert_eq!(ended.status, 0, "{}", ended.err);
    let strict = mocc(folder.path(), &["check", "units.mo", "--units=error", "--json"]);
    assert_eq!(strict.status, 1);
    let all: serde_json::Value = serde_json::from_str(&strict.out).expect("JSON");
    let lines: Vec<(&str, u64)> = all
        .as_array()
        .expect("a list")
        .iter()
        .map(|p| (p["severity"].as_str().expect("a word"), p["line"].as_u64().expect("a line")))
        .collect();
    // The share, the force, the speed taken for a pressure, and the exponent; nothing of what is right.
    assert_eq!(lines, [("error", 14), ("error", 20), ("error", 50), ("error", 55)]);
}
