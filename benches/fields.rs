//! Diagnoses of models from other fields than valves: rotation, circuits, heat, fluids, chemistry.
//!
//! A case in `benches/fields` is one text with the model and, behind `//|` and `//+`, the lines that the truth has
//! instead or in addition. A run draws the parameters of the truth and the conditions of its recordings, simulates
//! these, adds the noise of the sensors, and diagnoses the model with the command `mocc`.
//!
//! ```sh
//! cargo bench --bench fields                          # all cases of the shipped library, one specimen each
//! cargo bench --bench fields -- --specimens 5 fan     # five specimens of one case
//! cargo bench --bench fields -- --first 100           # other random numbers
//! cargo bench --bench fields -- --lib PATH            # with the cases of the Standard Library at PATH
//! ```

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use mocc::base::diag::Problems;
use mocc::base::document::{Item, Section};
use mocc::base::source::SourceMap;
use mocc::base::toml_file;
use serde_json::{Map, Value};

/// Recordings beyond those that are fitted: for validation and for the test.
const HELD_OUT: usize = 2;
/// Specimens whose model fits this well show nothing of what the model lacks.
const VISIBLE: f64 = 1.15;

/// How a diagnosis can end, best first.
const OUTCOMES: [&str; 6] = [
    "right",
    "grouped with the truth",
    "right with something else",
    "wrong",
    "unexplained",
    "invisible",
];

fn main() {
    let options = Options::read();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/fields");
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder)
        .expect("the cases")
        .map(|entry| entry.expect("a case").path())
        .collect();
    paths.sort();
    let mut tally = [0; OUTCOMES.len()];
    for path in paths {
        let name = path.file_stem().and_then(|s| s.to_str()).expect("a name").to_owned();
        let case = Case::read(&name, &path);
        let is_chosen = options.names.is_empty() || options.names.contains(&name);
        if !is_chosen || case.needs_library && options.library.is_none() {
            continue;
        }
        for seed in options.first..options.first + options.specimens {
            if let Some(outcome) = case.diagnose(seed, &options) {
                tally[outcome] += 1;
            }
        }
    }
    for (outcome, number) in OUTCOMES.iter().zip(tally) {
        println!("{number:4}  {outcome}");
    }
}

/// The arguments of the command line.
struct Options {
    names: Vec<String>,
    specimens: u64,
    first: u64,
    library: Option<String>,
}

impl Options {
    fn read() -> Options {
        let mut options = Options { names: Vec::new(), specimens: 1, first: 1, library: None };
        let mut arguments = std::env::args().skip(1).filter(|a| a != "--bench");
        while let Some(argument) = arguments.next() {
            let mut number = || arguments.next().and_then(|a| a.parse().ok()).expect("a number");
            match argument.as_str() {
                "--specimens" => options.specimens = number(),
                "--first" => options.first = number(),
                "--lib" => options.library = arguments.next(),
                _ => options.names.push(argument),
            }
        }
        options
    }
}

/// A model, what it lacks, and how it is recorded.
struct Case {
    name: String,
    needs_library: bool,
    /// Text of the model and of the truth.
    model: String,
    truth: String,
    plan: String,
    recordings: usize,
    /// Ranges of parameters of the truth: one value a specimen, and one value a recording.
    of_truth: Vec<(String, [f64; 2])>,
    of_recordings: Vec<(String, [f64; 2])>,
    /// What may be found: values of `component`, `at` and `over`; empty for a complete model.
    accepted: Vec<Value>,
}

impl Case {
    fn read(name: &str, path: &Path) -> Case {
        let text = std::fs::read_to_string(path).expect("a case");
        let table = toml(&text);
        let text = |key: &str| table[key].as_str().expect("a text").to_owned();
        let (mut model, mut truth) = (String::new(), String::new());
        for line in text("model").lines() {
            let (own, other) = match (line.split_once("//|"), line.split_once("//+")) {
                (Some((own, other)), _) => (own, other),
                (_, Some((own, more))) => (own, more),
                _ => (line, line),
            };
            writeln!(model, "{own}").expect("a String");
            writeln!(truth, "{other}").expect("a String");
        }
        let accepted = table["accepted"].as_array().expect("a list");
        Case {
            name: name.to_owned(),
            needs_library: table.get("library").is_some(),
            model,
            truth,
            plan: text("plan"),
            recordings: table["recordings"].as_f64().expect("a number") as usize,
            of_truth: ranges(&table["truth"]),
            of_recordings: ranges(&table["each"]),
            accepted: accepted.clone(),
        }
    }

    /// Records a specimen and diagnoses it; the position in [`OUTCOMES`].
    fn diagnose(&self, seed: u64, options: &Options) -> Option<usize> {
        let folder = std::env::temp_dir().join(format!("mocc-fields/{}-{seed}", self.name));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(folder.join("truth")).expect("a folder");
        let mut random = Random::new(seed, &self.name);
        if !self.record(&folder, &mut random, options) {
            println!("{} {seed}: cannot be simulated", self.name);
            return None;
        }
        let started = Instant::now();
        let mut command = mocc(&folder, options);
        command.args(["diagnose", "plan.toml", "--out", "out", "--quiet"]);
        let ended = command.output().expect("mocc");
        let seconds = started.elapsed().as_secs_f64();
        let Ok(text) = std::fs::read_to_string(folder.join("out/diagnosis.json")) else {
            println!("{} {seed}: {}", self.name, String::from_utf8_lossy(&ended.stderr));
            return None;
        };
        let found: Value = serde_json::from_str(&text).expect("JSON");
        let outcome = self.outcome(&found);
        println!(
            "{:18} {seed:3}  {:26} {}  {seconds:.1} s",
            self.name,
            OUTCOMES[outcome],
            words(&found)
        );
        Some(outcome)
    }

    fn record(&self, folder: &Path, random: &mut Random, options: &Options) -> bool {
        write(&folder.join("rig.mo"), &self.model);
        write(&folder.join("truth/truth.mo"), &self.truth);
        let plan = "model = \"rig.mo\"\nname = \"Rig\"\n[data]\nfolder = \".\"\ntable = \"table.csv\"\nfile = \"file\"\nsplit = \"split\"\n\
                    [time]\ncolumn = \"t\"\nunit = \"s\"\n"
            .to_owned()
            + &self.plan;
        write(&folder.join("plan.toml"), &plan);
        let own: Vec<(String, f64)> = self.of_truth.iter().map(|r| random.within(r)).collect();
        let names: Vec<&str> = self.of_recordings.iter().map(|(name, _)| name.as_str()).collect();
        let mut table = format!("file,split,{}\n", names.join(","));
        for k in 0..self.recordings + HELD_OUT {
            let split = match k.checked_sub(self.recordings) {
                None => "train",
                Some(0) => "validation",
                Some(_) => "test",
            };
            let each: Vec<(String, f64)> =
                self.of_recordings.iter().map(|r| random.within(r)).collect();
            let values: Vec<String> = each.iter().map(|(_, x)| x.to_string()).collect();
            writeln!(table, "{k}.csv,{split},{}", values.join(",")).expect("a String");
            let mut command = mocc(folder, options);
            command.args([
                "simulate",
                "truth/truth.mo",
                "--model",
                "Rig",
                "--tolerance",
                "1e-8",
                "--output",
                "exact.csv",
                "--quiet",
            ]);
            own.iter().chain(&each).for_each(|(name, value)| {
                command.arg("--set").arg(format!("{name}={value}"));
            });
            let ended = command.output().expect("mocc");
            if !ended.status.success() {
                print!("{}", String::from_utf8_lossy(&ended.stderr));
                return false;
            }
            let exact = std::fs::read_to_string(folder.join("exact.csv")).expect("a result");
            write(&folder.join(format!("{k}.csv")), &self.measured(&exact, random));
        }
        write(&folder.join("table.csv"), &table);
        true
    }

    /// Columns of the plan with noise, one row for each instant.
    fn measured(&self, exact: &str, random: &mut Random) -> String {
        let plan = toml(&self.plan);
        let entries = |key: &str| plan[key].as_object().into_iter().flatten();
        let mut lines = exact.lines();
        let header: Vec<&str> = lines.next().expect("a header").split(',').collect();
        let column = |variable: &str| {
            header
                .iter()
                .position(|h| h.trim_matches('"').split(' ').next() == Some(variable))
                .expect("a variable")
        };
        // Name in the recording, column of the result, noise.
        let mut columns = vec![("t".to_owned(), 0, 0.0)];
        for (name, entry) in entries("inputs") {
            columns.push((name.clone(), column(entry["input"].as_str().expect("a name")), 0.0));
        }
        for (name, entry) in entries("signals") {
            let variable = column(entry["variable"].as_str().expect("a name"));
            columns.push((name.clone(), variable, entry["sigma"].as_f64().expect("a number")));
        }
        let names: Vec<&str> = columns.iter().map(|c| c.0.as_str()).collect();
        let mut text = names.join(",") + "\n";
        // Where an input jumps there are two rows; the later one sees the input from then on.
        let mut rows: Vec<Vec<f64>> = Vec::new();
        for line in lines {
            let row: Vec<f64> = line.split(',').map(|x| x.parse().unwrap_or(f64::NAN)).collect();
            if row.iter().any(|x| x.is_nan()) {
                continue;
            }
            rows.pop_if(|last| last[0] >= row[0]);
            rows.push(row);
        }
        for row in rows {
            let values: Vec<String> = columns
                .iter()
                .map(|&(_, k, sigma)| (row[k] + sigma * random.normal()).to_string())
                .collect();
            writeln!(text, "{}", values.join(",")).expect("a String");
        }
        text
    }

    fn outcome(&self, found: &Value) -> usize {
        let is_complete = found["verdict"] == "complete";
        if self.accepted.is_empty() {
            return if is_complete { 0 } else { 3 };
        }
        if is_complete {
            let before = found["before"]["train"]["chi2"].as_f64().unwrap_or(f64::NAN);
            return if before < VISIBLE { 5 } else { 4 };
        }
        if found["verdict"] != "effect_found" {
            return 4;
        }
        let effects = found["effects"].as_array().expect("a list");
        let right = effects.iter().filter(|e| self.is_accepted(e)).count();
        let grouped = found["indistinguishable"].to_string();
        match (right, effects.len()) {
            (0, _) if self.accepted.iter().any(|a| is_named(a, &grouped)) => 1,
            (0, _) => 3,
            (right, all) if right == all => 0,
            _ => 2,
        }
    }

    fn is_accepted(&self, effect: &Value) -> bool {
        self.accepted.iter().any(|a| {
            let any = |key: &str, fits: &dyn Fn(&str) -> bool| match a.get(key) {
                None => true,
                Some(Value::String(one)) => fits(one),
                Some(Value::Array(all)) => all.iter().filter_map(Value::as_str).any(fits),
                Some(_) => panic!("{}: `{key}` is a text or a list", self.name),
            };
            let component = effect["component"].as_str().unwrap_or("");
            let holds = |key: &str, text: &str| effect[key].to_string().contains(text);
            any("component", &|c| component.rsplit('.').next() == Some(c))
                && any("at", &|at| holds("at", at))
                && any("over", &|over| holds("over", &format!("\"{over}\"")))
        })
    }
}

/// Whether one of the accepted classes occurs in a text.
fn is_named(accepted: &Value, text: &str) -> bool {
    let classes = accepted["component"].as_array();
    classes.into_iter().flatten().filter_map(Value::as_str).any(|class| text.contains(class))
}

/// What was found, and how far the residual fell.
fn words(found: &Value) -> String {
    let text = |value: &Value| value.as_str().unwrap_or("?").to_owned();
    let effects: Vec<String> = found["effects"]
        .as_array()
        .into_iter()
        .flatten()
        .map(|e| {
            format!(
                "{} at {} over {} [{}]",
                text(&e["component"]),
                e["at"],
                e["over"],
                text(&e["law"])
            )
        })
        .collect();
    let chi2 = |when: &str, split: &str| found[when][split]["chi2"].as_f64().unwrap_or(f64::NAN);
    format!(
        "{}: {}  train {:.4} -> {:.4}  validation {:.4} -> {:.4}",
        text(&found["verdict"]),
        effects.join(" + "),
        chi2("before", "train"),
        chi2("after", "train"),
        chi2("before", "validation"),
        chi2("after", "validation"),
    )
}

fn mocc(folder: &Path, options: &Options) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_mocc"));
    command.current_dir(folder);
    if let Some(library) = &options.library {
        command.env("MODELICAPATH", library);
    }
    command
}

fn write(path: &Path, text: &str) {
    std::fs::write(path, text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
}

fn ranges(table: &Value) -> Vec<(String, [f64; 2])> {
    let number = |v: &Value| v.as_f64().expect("a number");
    let table = table.as_object().expect("a table");
    table
        .iter()
        .map(|(name, range)| (name.clone(), [number(&range[0]), number(&range[1])]))
        .collect()
}

/// A text in TOML.
fn toml(text: &str) -> Value {
    let (mut sources, mut problems) = (SourceMap::default(), Problems::new());
    let path = Path::new("case.toml");
    let read = toml_file::read(path, text, &mut sources, &mut problems, |_, root| table(root));
    read.unwrap_or_else(|| panic!("not TOML: {text}"))
}

fn table(section: Section<'_>) -> Value {
    Value::Object(
        section.entries().into_iter().map(|(key, item)| (key, value(item))).collect::<Map<_, _>>(),
    )
}

fn value(item: Item<'_>) -> Value {
    let text = || item.text().map(Value::from);
    let number = || item.number().map(Value::from);
    let flag = || item.flag().map(Value::from);
    let list = || item.list().map(|all| all.into_iter().map(value).collect());
    let section = || item.section().map(table);
    text().or_else(number).or_else(flag).or_else(list).or_else(section).unwrap_or(Value::Null)
}

/// A small generator of random numbers (Marsaglia 2003, xorshift).
struct Random(u64);

impl Random {
    fn new(seed: u64, name: &str) -> Random {
        let start = name.bytes().fold(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15), |h, b| {
            (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3)
        });
        Random(start | 1)
    }

    fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }

    /// A value within a range, evenly distributed over its logarithm where that spans more than a factor of two.
    fn within(&mut self, (name, [low, high]): &(String, [f64; 2])) -> (String, f64) {
        let u = self.uniform();
        let value = match *low > 0.0 && high / low > 2.0 {
            true => low * (high / low).powf(u),
            false => low + (high - low) * u,
        };
        (name.clone(), value)
    }
}
