//! Several ways to the same result: three methods, two tolerances, the flat model printed and read again,
//! the lines of a model in another order, and a run that records a single variable must agree to the tolerance, or say
//! why not.
//!
//! Every model of the suite and the examples that runs without errors is run in each way by the program
//! itself; rows throughout the run are compared, each variable with what it reaches during the run.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use super::door::Scratch;
use super::permutation::{permuted, reversed};
use super::suite::case::{cases, stages};

/// Distance of two results, relative to the largest value of the variable.
const AGREEMENT: f64 = 1e-3;
/// Where in the run results are compared, as fractions of it: at its end, and at simple fractions, there may be
/// an event, and rounding decides whether it still happens.
const COMPARED: [f64; 6] = [0.1234, 0.2871, 0.4463, 0.6139, 0.7877, 0.973];
/// Values below this are zero.
const NOTHING: f64 = 1e-9;
/// Limit of each run, s.
const MOST_SECONDS: &str = "10";

#[test]
fn ways_to_the_same_result_agree() {
    let found = compare(Duration::from_secs(60), 9);
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// `MOCC_BINARY=target/release/mocc cargo test --test all -- --ignored --nocapture differential::`; with
/// `MOCC_MODELS=DIR` the models in the files of a folder are compared instead.
#[test]
#[ignore = "takes some minutes"]
fn all_ways_to_the_same_result_agree() {
    let found = compare(Duration::from_secs(3600), 1);
    assert!(found.is_empty(), "{} disagree:\n{}", found.len(), found.join("\n"));
}

/// The largest absolute value of each variable, and those that are compared.
type Outcome = BTreeMap<String, (f64, Vec<f64>)>;

/// Compares every `each`-th model until the time is over; the disagreements, one a line.
fn compare(time: Duration, each: usize) -> Vec<String> {
    let begun = Instant::now();
    let scratch = Scratch::new();
    let (mut models, mut runs, mut found) = (0, 0, Vec::new());
    // The number of runs that each message refused.
    let mut refused: BTreeMap<String, usize> = BTreeMap::new();
    for (name, text) in models_of_the_repository().into_iter().step_by(each) {
        if begun.elapsed() > time {
            break;
        }
        let Ok(reference) = run(&scratch, &text, &["--tolerance", "1e-8"]) else { continue };
        models += 1;
        let ways: [&[&str]; 5] = [
            &["--method", "radau", "--tolerance", "1e-8"],
            &["--method", "bdf", "--tolerance", "1e-8"],
            &["--method", "dopri", "--tolerance", "1e-8"],
            &["--tolerance", "1e-6"],
            &["--mode", "dae", "--tolerance", "1e-8"],
        ];
        let mut others: Vec<(String, Result<Outcome, String>)> =
            ways.into_iter().map(|way| (way.join(" "), run(&scratch, &text, way))).collect();
        if let Some(flat) = flat(&scratch, &text) {
            others.push(("flat model".into(), run(&scratch, &flat, &["--tolerance", "1e-8"])));
        }
        if let Some(permuted) = permuted(&text, reversed) {
            let way = "lines in reverse order".to_owned();
            others.push((way, run(&scratch, &permuted, &["--tolerance", "1e-8"])));
        }
        let mut names = reference.keys().filter(|name| *name != "time");
        let first = names.next();
        for name in first.into_iter().chain(names.next_back()) {
            let way = ["--tolerance", "1e-8", "--variables", &pattern(name)];
            others.push((format!("only `{name}` recorded"), run(&scratch, &text, &way)));
        }
        for (way, outcome) in others {
            runs += 1;
            match outcome {
                Ok(outcome) => {
                    if let Some(what) = difference(&reference, &outcome) {
                        found.push(format!("{name}, {way}: {what}"));
                    }
                }
                // A message is an answer, but that of a method that cannot take the model is no news.
                Err(why) if why.is_empty() => found.push(format!("{name}, {way}: no message")),
                Err(why) => *refused.entry(first_words(&why)).or_default() += 1,
            }
        }
    }
    eprintln!(
        "{models} models, {runs} other ways: {} disagree, {} refused with a message, in {:.0} s",
        found.len(),
        refused.values().sum::<usize>(),
        begun.elapsed().as_secs_f64()
    );
    for (why, count) in refused {
        eprintln!("{count} refused: {why}");
    }
    found
}

/// A message up to its numbers and names.
fn first_words(message: &str) -> String {
    let line = message.lines().find(|line| line.starts_with("error")).unwrap_or_default();
    let is_place = |c: char| c == '`' || c.is_ascii_digit();
    // The digits of a code are none of the message.
    let text = line.find("]: ").map_or(0, |at| at + 3);
    let end = line[text..].find(is_place).map_or(line.len(), |at| text + at);
    line[..end].trim_end().to_owned()
}

/// Names and texts.
fn models_of_the_repository() -> Vec<(String, String)> {
    let mut all: Vec<(String, String)> = Vec::new();
    let given = std::env::var_os("MOCC_MODELS").map(PathBuf::from);
    let suite = if given.is_some() { Vec::new() } else { stages() };
    for case in suite.iter().flat_map(|s| cases(s).unwrap_or_else(|why| panic!("{why}"))) {
        if case.problems.is_empty() && case.status == 0 {
            all.push((case.full_name(), case.model.clone()));
        }
    }
    let examples = || Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let folder = given.unwrap_or_else(examples);
    let entries = std::fs::read_dir(folder).expect("a folder").flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    paths.sort();
    let is_model = |p: &PathBuf| p.extension().is_some_and(|e| e == "mol" || e == "mo");
    for path in paths.into_iter().filter(is_model) {
        let text = std::fs::read_to_string(&path).expect("a text");
        all.push((path.display().to_string(), text));
    }
    all
}

fn program(scratch: &Scratch) -> Command {
    let program = std::env::var("MOCC_BINARY");
    let program = program.unwrap_or_else(|_| env!("CARGO_BIN_EXE_mocc").to_owned());
    let mut command = Command::new(Path::new(env!("CARGO_MANIFEST_DIR")).join(program));
    command.current_dir(scratch.path());
    command
}

/// The flat model of a text; `None` if it cannot be printed.
fn flat(scratch: &Scratch, text: &str) -> Option<String> {
    scratch.file("model.mo", text);
    let output = program(scratch).args(["flatten", "model.mo"]).output().expect("mocc starts");
    output.status.success().then(|| String::from_utf8(output.stdout).expect("UTF-8"))
}

/// The regular expression that matches just this name.
fn pattern(name: &str) -> String {
    let escaped = name.chars().flat_map(|c| {
        let escape = (!c.is_alphanumeric() && c.is_ascii()).then_some('\\');
        escape.into_iter().chain([c])
    });
    format!("^{}$", escaped.collect::<String>())
}

/// Runs a text; the error is what mocc says.
fn run(scratch: &Scratch, text: &str, way: &[&str]) -> Result<Outcome, String> {
    scratch.file("model.mo", text);
    let mut command = program(scratch);
    command.args(["simulate", "model.mo", "--output", "out.csv", "--max-seconds", MOST_SECONDS]);
    let output = command.args(way).stdout(Stdio::null()).output().expect("mocc starts");
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    let table = std::fs::read_to_string(scratch.path().join("out.csv")).expect("a table");
    Ok(read(&table))
}

/// Columns of a table that mocc wrote; names with commas are in double quotes.
fn read(table: &str) -> Outcome {
    let mut lines = table.lines();
    let head = lines.next().unwrap_or_default();
    let mut names = vec![String::new()];
    let mut quoted = false;
    for c in head.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => names.push(String::new()),
            c => names[0..].last_mut().expect("one").push(c),
        }
    }
    let rows: Vec<Vec<f64>> = lines
        .map(|line| line.split(',').map(|value| value.parse().unwrap_or(f64::NAN)).collect())
        .collect();
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return Outcome::new() };
    let at = |fraction: f64| {
        let time = first[0] + fraction * (last[0] - first[0]);
        rows.iter().rev().find(|row| row[0] <= time).unwrap_or(first)
    };
    let compared = COMPARED.map(at);
    let largest = |k: usize| rows.iter().map(|row| row[k].abs()).fold(0.0, f64::max);
    let values = |k: usize| compared.iter().map(|row| row[k]).collect();
    names.into_iter().enumerate().map(|(k, name)| (name, (largest(k), values(k)))).collect()
}

/// The first variable of which two runs say something else.
fn difference(reference: &Outcome, other: &Outcome) -> Option<String> {
    let ends = |outcome: &Outcome| outcome["time"].0;
    if (ends(reference) - ends(other)).abs() > AGREEMENT * ends(reference) {
        return Some(format!("ends at {} instead of {}", ends(other), ends(reference)));
    }
    let times = &reference["time"].1;
    reference.iter().find_map(|(name, (size, expected))| {
        // Derivatives of fast components follow from the others, with a larger error.
        let (_, found) = other.get(name).filter(|_| !name.starts_with("der("))?;
        let differs = |k: &usize| (found[*k] - expected[*k]).abs() > AGREEMENT * size + NOTHING;
        let k = (0..COMPARED.len()).find(differs)?;
        Some(format!("`{name}` is {} instead of {} at {} s", found[k], expected[k], times[k]))
    })
}
