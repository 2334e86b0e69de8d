//! Broken sources: whatever a file contains, mocc reports it soon and never panics.
//!
//! The models of the suite and the examples are changed at random, token by token (Miller, Fredriksen and
//! So 1990; the operators are those of grammar-free mutation), and checked. The generator has a fixed
//! seed: a failure names the number of its text, which can be made again.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::time::Duration;

use mocc::base::diag::Severity;
use mocc::base::render::{Style, render_all};
use mocc::driver::compile::{Request, Session};

use super::door::Scratch;
use super::suite::case::{cases, stages};

/// Nobody waits longer for an answer, not even on a busy machine and without optimisation.
const PATIENCE: Duration = Duration::from_secs(30);
/// As that of the program.
const STACK: usize = 1 << 30;

#[test]
fn sources_that_are_changed_at_random_are_answered() {
    answered(0..400);
}

/// `cargo test --test all -- --ignored many_sources`, for a quiet half hour.
#[test]
#[ignore = "takes half an hour"]
fn many_sources_that_are_changed_at_random_are_answered() {
    answered(400..400_000);
}

#[test]
fn what_is_nested_deeply_is_refused_or_answered() {
    let deep = |n: usize, open: &str, inner: &str, close: &str| {
        [open.repeat(n).as_str(), inner, close.repeat(n).as_str()].concat()
    };
    for n in [200, 20_000] {
        let inputs = [
            format!("model M\n  Real x = {};\nend M;\n", deep(n, "(", "1", ")")),
            format!("model M\n  Real x = {};\nend M;\n", deep(n, "-(", "1", ")")),
            format!("model M\n  Real x = {}1;\nend M;\n", "1 + ".repeat(n)),
            format!("model M\n  Real x = {};\nend M;\n", deep(n, "sin(", "1", ")")),
            format!("model M\n  Real x = {};\nend M;\n", deep(n, "if true then ", "1", " else 2")),
            format!("model M\n  Real x[:] = {};\nend M;\n", deep(n, "{", "1", "}")),
            format!("model M\nequation\n{}\nend M;\n", deep(n, "if true then ", "", "end if;\n")),
            format!(
                "model M\nalgorithm\n{}\nend M;\n",
                deep(n, "while true loop ", "", "end while;\n")
            ),
            format!("model M\n  Real x({}) = 1;\nend M;\n", deep(n, "a(", "b = 1", ")")),
            format!("model M\n  Real x = {}y;\nend M;\n", "a.".repeat(n)),
            format!("model M\n  Real x = a{};\nend M;\n", deep(n, "[a", "", "]")),
            format!("{}Real x = 1;\n{}", named(n, "model M"), ended(n)),
            // Each class of a file is checked by itself.
            chain(n.min(250), |k| format!("model M{k}\n  extends M{};\nend M{k};\n", k + 1)),
            chain(n.min(250), |k| format!("model M{k}\n  M{} m;\nend M{k};\n", k + 1)),
            chain(n.min(250), |k| format!("type M{k} = M{};\n", k + 1)),
        ];
        let scratch = Scratch::new();
        for (k, text) in inputs.into_iter().enumerate() {
            let file = scratch.file("deep.mo", &text);
            let start: String = text.chars().take(60).collect();
            if let Err(why) = answer(file) {
                panic!("{why}: text {k} of depth {n}: {start}");
            }
        }
    }
}

fn named(n: usize, what: &str) -> String {
    (0..n).map(|k| format!("{what}{k}\n")).collect()
}

fn ended(n: usize) -> String {
    (0..n).rev().map(|k| format!("end M{k};\n")).collect()
}

fn chain(n: usize, link: impl Fn(usize) -> String) -> String {
    let links: String = (0..n).map(link).collect();
    format!("{links}type M{n} = Real;\nmodel Test\n  M0 m;\nend Test;\n")
}

fn answered(numbers: std::ops::Range<u64>) {
    let inputs = sources();
    let words: Vec<Vec<&str>> = inputs.iter().map(|t| tokens(t)).collect();
    let scratch = Scratch::new();
    for number in numbers {
        let text = mutant(&words, number);
        let file = scratch.file("mutant.mo", &text);
        if let Err(why) = answer(file) {
            panic!("{why}: text {number}:\n{text}");
        }
    }
}

/// Checks a file; the error says how mocc failed if it did not answer.
fn answer(file: PathBuf) -> Result<(), String> {
    let (send, receive) = mpsc::channel();
    let work = move || {
        let request = Request { file: Some(file), ..Request::default() };
        let said = catch_unwind(AssertUnwindSafe(|| {
            let mut session = Session::default();
            let accepted = session.check(&request, Severity::Warning).is_ok();
            let text = render_all(&session.problems, &session.sources, Style::Plain);
            (accepted, session.problems.has_errors(), text)
        }));
        // Nobody listens any more after the time is over.
        let _ = send.send(said.map_err(|_| "a panic".to_string()));
    };
    let worker = std::thread::Builder::new().stack_size(STACK).spawn(work);
    worker.map_err(|e| e.to_string())?;
    let (accepted, errors, text) =
        receive.recv_timeout(PATIENCE).map_err(|_| "no answer".to_string())??;
    if accepted == errors {
        return Err(format!("accepted with errors, or refused without:\n{text}"));
    }
    if text.contains("bug in mocc") {
        return Err(text);
    }
    Ok(())
}

/// All models of the suite and the examples, in order of their names.
pub fn sources() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .expect("a folder")
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|e| e == "mol"))
        .collect();
    files.sort();
    let examples = files.iter().map(|f| std::fs::read_to_string(f).expect("a model"));
    let cases = stages().into_iter().flat_map(|s| cases(&s).unwrap_or_else(|why| panic!("{why}")));
    let sources: Vec<String> = cases.map(|c| c.model).chain(examples).collect();
    assert!(sources.len() > 100);
    sources
}

/// Words, numbers, signs and the space between them.
pub fn tokens(text: &str) -> Vec<&str> {
    let kind = |c: char| match c {
        c if c.is_alphanumeric() || c == '_' => 0,
        c if c.is_whitespace() => 1,
        _ => 2,
    };
    let mut out = Vec::new();
    let mut begun = 0;
    let mut last = None;
    for (at, c) in text.char_indices() {
        let of = kind(c);
        if last.is_some_and(|l| l != of || of == 2) {
            out.push(&text[begun..at]);
            begun = at;
        }
        last = Some(of);
    }
    out.push(&text[begun..]);
    out
}

/// Tokens that are inserted besides those of the sources.
const SPICE: [&str; 40] = [
    "end",
    "if",
    "then",
    "else",
    "for",
    "in",
    "loop",
    "when",
    "while",
    "der",
    "(",
    ")",
    "{",
    "}",
    "[",
    "]",
    ":",
    ";",
    "=",
    ":=",
    "+",
    "-",
    "^",
    ".",
    ",",
    "\"",
    "'",
    "0",
    "-1",
    "1e308",
    "1e-320",
    "9223372036854775807",
    "1000000000",
    "extends",
    "redeclare",
    "replaceable",
    "outer",
    "each",
    "final",
    "within",
];

/// Source `number`: one of the sources with up to eight changes.
fn mutant(words: &[Vec<&str>], number: u64) -> String {
    let mut random = Random::of(number);
    let pick = random.below(words.len());
    let mut text = words[pick].clone();
    for _ in 0..1 + random.below(8) {
        if text.is_empty() {
            break;
        }
        let at = random.below(text.len());
        match random.below(9) {
            0 => {
                text.remove(at);
            }
            1 => text.insert(at, text[at]),
            2 => {
                let other = random.below(text.len());
                text.swap(at, other);
            }
            3 => text[at] = SPICE[random.below(SPICE.len())],
            4 => text.insert(at, SPICE[random.below(SPICE.len())]),
            5 => {
                let donor = &words[random.below(words.len())];
                text[at] = donor[random.below(donor.len())];
            }
            // A piece of another text.
            6 => {
                let donor = &words[random.below(words.len())];
                let from = random.below(donor.len());
                let to = (from + 1 + random.below(30)).min(donor.len());
                text.splice(at..at, donor[from..to].iter().copied());
            }
            // A name or a number in the place of another one.
            7 => {
                let other = random.below(text.len());
                text[at] = text[other];
            }
            _ => {
                let end = (at + 1 + random.below(20)).min(text.len());
                text.drain(at..end);
            }
        }
    }
    text.concat()
}

/// Marsaglia's xorshift* (Vigna 2016).
pub struct Random(u64);

impl Random {
    /// The sequence of a number.
    pub fn of(number: u64) -> Random {
        Random(number.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    /// An Integer from 0 to `n - 1`.
    pub fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let high = self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 32;
        (high as usize * n) >> 32
    }
}
