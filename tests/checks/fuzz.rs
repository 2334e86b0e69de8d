//! Models that are changed at random, with a sense of what they are made of, and simulated: whatever a
//! file contains, mocc answers within seconds and never aborts.
//!
//! The models of the suite, the library and the examples are changed by statement, name, number, operator
//! and prefix (Miller, Fredriksen and So 1990; structure as in Holler, Herzig and Zeller, *Fuzzing with
//! code fragments*, 2012), then checked and simulated by the program itself, with a method, a tolerance
//! and a stop time drawn as well. A process of its own for each shows aborts, and its limits show what
//! takes too long or too much. The generator has a seed: a failure names the number of its text.

use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use super::door::Scratch;
use super::mutation::{Random, sources, tokens};

/// No command takes longer, s.
const MOST_SECONDS: &str = "10";
/// No command takes more memory, GB.
const MOST_MEMORY: &str = "2";

#[test]
fn changed_models_are_simulated_or_refused() {
    let failures = fuzz(1..40, Duration::from_secs(120));
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// `MOCC_FUZZ_SECONDS=7200 MOCC_FUZZ_SEED=1 MOCC_BINARY=target/release/mocc cargo test --test all -- \
/// --ignored --nocapture fuzz::`, for a quiet evening; docs/reliability.md tells what was found.
#[test]
#[ignore = "takes as long as it is told"]
fn many_changed_models_are_simulated_or_refused() {
    let number = |name: &str, default: u64| {
        std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(default)
    };
    let seed = number("MOCC_FUZZ_SEED", 1) * 1_000_000_000;
    let time = Duration::from_secs(number("MOCC_FUZZ_SECONDS", 600));
    let failures = fuzz(seed..u64::MAX, time);
    assert!(failures.is_empty(), "{} failures:\n{}", failures.len(), failures.join("\n"));
}

/// Tries the texts of these numbers until the time is over; the failures, one a line.
fn fuzz(numbers: std::ops::Range<u64>, time: Duration) -> Vec<String> {
    let mut all = sources();
    all.extend(library());
    let words: Vec<Vec<&str>> = all.iter().map(|text| tokens(text)).collect();
    let begun = Instant::now();
    let scratch = Scratch::new();
    let mut failures = Vec::new();
    let (mut texts, mut simulated, mut finished, mut limited) = (0_u64, 0_u64, 0_u64, 0_u64);
    for number in numbers {
        if begun.elapsed() > time {
            break;
        }
        let mut random = Random::of(number);
        let text = mutant(&words, &mut random);
        let file = scratch.file("mutant.mo", &text);
        texts += 1;
        let checked = run(&scratch, &["check"], &file);
        let mut failure = checked.failure().map(str::to_owned);
        if failure.is_none() && checked.status.code() == Some(0) {
            let (arguments, described) = settings(&mut random);
            let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
            let ran = run(&scratch, &arguments, &file);
            simulated += 1;
            finished += u64::from(ran.status.code() == Some(0));
            // A run that has much to do is no hang: it shows its progress, and ends when told.
            match ran.failure() {
                Some("time") => {
                    limited += 1;
                    let kept = keep(number, &text);
                    eprintln!("text {number} runs for long ({described}), {}", kept.display());
                }
                ended => failure = ended.map(|why| format!("{why} ({described})")),
            }
        }
        if let Some(why) = failure {
            let kept = keep(number, &text);
            failures.push(format!("{why}: text {number}, {}", kept.display()));
            eprintln!("{}", failures[failures.len() - 1]);
        }
    }
    eprintln!(
        "{texts} texts in {:.0} s: {simulated} passed `check`, {finished} of these ran to their end, \
         {limited} to the limit of {MOST_SECONDS} s; {} failures",
        begun.elapsed().as_secs_f64(),
        failures.len()
    );
    failures
}

/// Keeps a text: its number tells which one it was only as long as the sources stay the same.
fn keep(number: u64, text: &str) -> PathBuf {
    let kept = std::env::temp_dir().join(format!("mocc-fuzz-{number}.mo"));
    // The message is worth more than the file.
    let _ = std::fs::write(&kept, text);
    kept
}

/// How a command ended.
struct Ended {
    status: ExitStatus,
    err: String,
}

impl Ended {
    /// What must never happen, if it did.
    fn failure(&self) -> Option<&'static str> {
        let says = |text: &str| self.err.contains(text);
        match self.status.code() {
            None => Some("ended by a signal"),
            Some(0..=3) if says("bug in mocc") => Some("a bug"),
            Some(0..=3) if says("the limit of") && says("of memory is reached") => Some("memory"),
            Some(0..=3) if says(" s is reached") => Some("time"),
            Some(0..=3) => None,
            Some(_) => Some("a panic or a bug"),
        }
    }
}

fn run(scratch: &Scratch, arguments: &[&str], file: &Path) -> Ended {
    let program = std::env::var("MOCC_BINARY");
    let program = program.unwrap_or_else(|_| env!("CARGO_BIN_EXE_mocc").to_owned());
    let program = Path::new(env!("CARGO_MANIFEST_DIR")).join(program);
    let mut command = Command::new(program);
    command.current_dir(scratch.path()).args(arguments).arg(file);
    command.args(["--max-seconds", MOST_SECONDS, "--max-memory", MOST_MEMORY]);
    command.env_remove("MODELICAPATH").stdout(Stdio::null());
    let output = command.output().expect("mocc starts");
    let err = String::from_utf8_lossy(&output.stderr).into_owned();
    Ended { status: output.status, err }
}

/// The arguments of a run, and those of them that were drawn.
fn settings(random: &mut Random) -> (Vec<String>, String) {
    const METHODS: [&str; 4] = ["auto", "radau", "bdf", "dopri"];
    const TOLERANCES: [&str; 4] = ["1e-3", "1e-6", "1e-9", "1e-12"];
    const STOPS: [&str; 4] = ["0.01", "0.1", "1", "10"];
    const MODES: [&str; 4] = ["reduced", "reduced", "reduced", "dae"];
    let drawn = [
        ("--method", METHODS[random.below(4)]),
        ("--tolerance", TOLERANCES[random.below(4)]),
        ("--stop", STOPS[random.below(4)]),
        ("--mode", MODES[random.below(4)]),
    ];
    let drawn: Vec<String> = drawn.iter().flat_map(|(k, v)| [(*k).into(), (*v).into()]).collect();
    let described = drawn.join(" ");
    let mut all: Vec<String> = ["simulate", "--output", "out.csv"].map(String::from).into();
    all.extend(drawn);
    (all, described)
}

/// The files of the shipped library.
fn library() -> Vec<String> {
    let mut found = Vec::new();
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("lib")];
    while let Some(folder) = folders.pop() {
        let entries = std::fs::read_dir(&folder).expect("a folder").flatten();
        let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
        paths.sort();
        for path in paths {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "mo") {
                found.push(std::fs::read_to_string(path).expect("a text"));
            }
        }
    }
    found
}

const NUMBERS: [&str; 14] = [
    "0",
    "1",
    "-1",
    "2",
    "0.5",
    "1e-12",
    "1e-3",
    "1e3",
    "1e12",
    "1e-300",
    "1e300",
    "3.7",
    "2147483648",
    "100",
];
const OPERATORS: [&str; 16] =
    ["+", "-", "*", "/", "^", "<", ">", "<=", ">=", "==", "<>", " and ", " or ", "=", ":=", ".*"];
const PREFIXES: [&str; 12] = [
    "parameter",
    "constant",
    "discrete",
    "flow",
    "input",
    "output",
    "final",
    "inner",
    "outer",
    "replaceable",
    "protected",
    "public",
];
const TYPES: [&str; 5] = ["Real", "Integer", "Boolean", "String", "StateSelect"];
/// What a name or a number may become: the text takes the place of `#`.
const AROUND: [&str; 28] = [
    "der(#)",
    "pre(#)",
    "sin(#)",
    "sqrt(#)",
    "log(#)",
    "exp(#)",
    "abs(#)",
    "sign(#)",
    "noEvent(#)",
    "smooth(0, #)",
    "delay(#, 0.1)",
    "integer(#)",
    "floor(#)",
    "mod(#, 2)",
    "max(#, 0)",
    "(-#)",
    "(#)^2",
    "(if # > 0 then # else 0)",
    "sum({#, #})",
    "(# + time)",
    "(#*time)",
    "1/(#)",
    "not #",
    "edge(#)",
    "(sample(0, 0.1) and #)",
    "size(#, 1)",
    "{#, #}[1]",
    "initial()",
];
/// Statements that are inserted; `#` is a name.
const STATEMENTS: [&str; 12] = [
    "der(#) = -#;",
    "# = 0;",
    "# = time;",
    "when # > 0.5 then reinit(#, 0); end when;",
    "if # > 0 then # = 1; else # = 2; end if;",
    "assert(# < 1, \"large\", AssertionLevel.warning);",
    "when sample(0, 0.1) then # = pre(#) + 1; end when;",
    "connect(#, #);",
    "equation",
    "algorithm",
    "initial equation",
    "for i in 1:3 loop # = i; end for;",
];

/// One of the sources with up to three changes.
fn mutant(words: &[Vec<&str>], random: &mut Random) -> String {
    let first = random.below(words.len());
    let mut text: Vec<String> = words[first].iter().map(|t| (*t).to_owned()).collect();
    for _ in 0..1 + random.below(3) {
        if text.is_empty() {
            break;
        }
        change(&mut text, words, random);
    }
    text.concat()
}

fn change(text: &mut Vec<String>, words: &[Vec<&str>], random: &mut Random) {
    let is_name = |t: &str| t.starts_with(|c: char| c.is_alphabetic() || c == '_');
    let is_number = |t: &str| t.starts_with(|c: char| c.is_ascii_digit());
    let pick = |text: &[String], random: &mut Random, wanted: &dyn Fn(&str) -> bool| {
        let all: Vec<usize> = (0..text.len()).filter(|k| wanted(&text[*k])).collect();
        (!all.is_empty()).then(|| all[random.below(all.len())])
    };
    let is_variable = |t: &str| is_name(t) && !KEYWORDS.contains(&t) && !TYPES.contains(&t);
    match random.below(12) {
        // A statement is removed, doubled, or moved.
        kind @ 0..=2 => {
            let ends: Vec<usize> = (0..text.len()).filter(|k| text[*k] == ";").collect();
            if ends.len() < 3 {
                return;
            }
            let k = random.below(ends.len() - 1);
            let statement: Vec<String> = text[ends[k] + 1..=ends[k + 1]].to_vec();
            let to = ends[random.below(ends.len())] + 1;
            match kind {
                0 => drop(text.drain(ends[k] + 1..=ends[k + 1])),
                1 => drop(text.splice(to..to, statement)),
                _ => {
                    text.splice(to..to, statement);
                    let shift = if to <= ends[k] { ends[k + 1] - ends[k] } else { 0 };
                    text.drain(ends[k] + 1 + shift..=ends[k + 1] + shift);
                }
            }
        }
        3 => {
            let (Some(at), Some(other)) =
                (pick(text, random, &is_variable), pick(text, random, &is_variable))
            else {
                return;
            };
            text[at] = text[other].clone();
        }
        4 => {
            let Some(at) = pick(text, random, &is_number) else { return };
            text[at] = NUMBERS[random.below(NUMBERS.len())].to_owned();
        }
        5 => {
            let is_operator = |t: &str| OPERATORS.contains(&t);
            let Some(at) = pick(text, random, &is_operator) else { return };
            text[at] = OPERATORS[random.below(OPERATORS.len())].to_owned();
        }
        6 | 7 => {
            let is_value = |t: &str| is_variable(t) || is_number(t);
            let Some(at) = pick(text, random, &is_value) else { return };
            text[at] = AROUND[random.below(AROUND.len())].replace('#', &text[at]);
        }
        8 => {
            let is_type = |t: &str| TYPES.contains(&t);
            let Some(at) = pick(text, random, &is_type) else { return };
            match random.below(3) {
                0 => text[at] = TYPES[random.below(TYPES.len())].to_owned(),
                1 => text.insert(at, format!("{} ", PREFIXES[random.below(PREFIXES.len())])),
                _ => text[at].push_str("[2]"),
            }
        }
        9 => {
            let is_end = |t: &str| t == ";";
            let (Some(at), Some(name)) =
                (pick(text, random, &is_end), pick(text, random, &is_variable))
            else {
                return;
            };
            let name = text[name].clone();
            let statement = STATEMENTS[random.below(STATEMENTS.len())].replace('#', &name);
            text.insert(at + 1, format!("\n  {statement}\n"));
        }
        // A statement of another source.
        10 => {
            let donor = &words[random.below(words.len())];
            let ends: Vec<usize> = (0..donor.len()).filter(|k| donor[*k] == ";").collect();
            let is_end = |t: &str| t == ";";
            let Some(at) = pick(text, random, &is_end) else { return };
            if ends.len() > 1 {
                let k = random.below(ends.len() - 1);
                let statement = donor[ends[k] + 1..=ends[k + 1]].iter().map(|t| (*t).to_owned());
                text.splice(at + 1..at + 1, statement.collect::<Vec<_>>());
            }
        }
        _ => {
            let Some(at) = pick(text, random, &is_variable) else { return };
            let start = NUMBERS[random.below(NUMBERS.len())];
            text[at].push_str(&format!("(start = {start}, fixed = true)"));
        }
    }
}

const KEYWORDS: [&str; 40] = [
    "model",
    "class",
    "package",
    "block",
    "record",
    "connector",
    "function",
    "type",
    "end",
    "equation",
    "algorithm",
    "initial",
    "if",
    "then",
    "else",
    "elseif",
    "for",
    "in",
    "loop",
    "when",
    "elsewhen",
    "while",
    "parameter",
    "constant",
    "discrete",
    "flow",
    "input",
    "output",
    "extends",
    "import",
    "within",
    "final",
    "each",
    "redeclare",
    "replaceable",
    "protected",
    "public",
    "and",
    "or",
    "not",
];
