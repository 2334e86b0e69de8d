//! The pages of `docs/errors/`: each code of the program has one, each wrong example reports exactly this code, and each
//! right one nothing at all.
//!
//! Files of an example are the fences below `` `NAME`: ``, a Modelica fence without name is `model.mo`, and a `sh` fence
//! holds the commands; without one the model is checked, or the plan is fitted. The right example keeps the files and
//! commands of the wrong one that it does not replace.
//!
//! After a page has been added or its heading changed, `DOCS_UPDATE=1 cargo test --test all errors` writes the lists of
//! pages again.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use mocc::driver::compile::{Request, Session};
use mocc::driver::files::error_pages;

use super::door::Scratch;
use super::program::mocc;

/// Codes that no example can cause here, each with the reason.
const WITHOUT_EXAMPLE: &[(&str, &str)] = &[
    ("MO0022", "needs a file of 4 GB"),
    ("MO0107", "the command line asks for a file or a model itself"),
    ("MO0313", "an earlier stage finds each initial when-clause of a model"),
    ("MO0409", "start values are assumed for all variables that are open at the start"),
    ("MO0801", "earlier stages reject each construct that is known to be unsupported"),
    ("MO0802", "is a bug in mocc"),
    ("MO0908", "initialization checks each value before the integrator reads it"),
    ("MO0917", "a calibration goes on with differences of runs"),
    ("MO0931", "follows eight warnings MO0919"),
    ("MO0945", "needs an FMU, whose bytes are not text"),
    ("MO0999", "is a bug in mocc"),
    ("MO1300", "the runtime may have been built next to the program"),
    ("MO1322", "its repair needs the runtime, which may not have been built"),
    ("MO1302", "all external functions of mocc can be written"),
    ("MO1304", "the operating system denies it"),
    ("MO1306", "needs an archive, whose bytes are not text"),
    ("MO1307", "needs a large archive"),
    ("MO1308", "needs an FMU, whose bytes are not text"),
    ("MO1309", "needs an FMU, whose bytes are not text"),
    ("MO1310", "needs an FMU, whose bytes are not text"),
    ("MO1311", "needs an FMU, whose bytes are not text"),
    ("MO1312", "needs an FMU, whose bytes are not text"),
    ("MO1313", "needs an FMU, whose bytes are not text"),
    ("MO1314", "needs an FMU, whose bytes are not text"),
    ("MO1315", "needs an FMU, whose bytes are not text"),
    ("MO1316", "needs an FMU, whose bytes are not text"),
    ("MO1318", "needs an FMU, whose bytes are not text"),
    ("MO1320", "needs an FMU, whose bytes are not text"),
    ("MO1321", "its repair needs an FMU, whose bytes are not text"),
    ("MO1323", "needs an FMU, whose bytes are not text"),
    ("MO1273", "the parser rejects every expression that is not a call"),
];

/// Codes whose wrong example reports further ones, each with the reason.
const FOLLOWED: &[(&str, &str)] =
    &[("MO1104", "the inner function of a measure is unknown to the model, too")];

/// Stack of a thread that checks examples, as large as that of the program: some recurse deeply.
const STACK: usize = 1 << 30;
/// The model that an example without names of files consists of.
const MODEL: &str = "model.mo";
const PLAN: &str = "plan.toml";
/// A stand-in for the runtime of FMUs, which may not have been built.
const STAND_IN: &[u8] =
    b"\x7fELF\0fmi3InstantiateCoSimulation\0fmi3DoStep\0fmi3GetContinuousStateDerivatives\0";

/// Groups of codes in the index: the title, and the first two digits.
const GROUPS: &[(&str, &[&str])] = &[
    ("Syntax", &["00"]),
    ("Files and libraries", &["01"]),
    ("Classes and expressions", &["02", "12"]),
    ("The flat model", &["03"]),
    ("Structure", &["04"]),
    ("Code", &["08"]),
    ("Run time", &["09"]),
    ("Plans and recordings", &["10"]),
    ("Measures", &["11"]),
    ("FMUs", &["13"]),
    ("Tests, projects and designs", &["14"]),
];

// ---- The examples ----

#[test]
fn examples_report_their_codes() {
    let pages: Vec<(String, String)> = pages().into_iter().collect();
    let plan = Example::of(&read("docs/errors/README.md"), "The example of the plans");
    let next = AtomicUsize::new(0);
    let broken = Mutex::new(BTreeMap::new());
    let work = || {
        while let Some((code, page)) = pages.get(next.fetch_add(1, Ordering::Relaxed)) {
            if let Err(why) = check(code, page, &plan) {
                broken.lock().expect("no thread panics").insert(code, why);
            }
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            let worker = std::thread::Builder::new().stack_size(STACK);
            worker.spawn_scoped(scope, work).expect("a thread");
        }
    });
    let broken = broken.into_inner().expect("no thread panics");
    let shown: Vec<&str> = broken.values().map(String::as_str).collect();
    assert!(broken.is_empty(), "\n{}\n", shown.join("\n"));
}

/// Runs both examples of a page.
fn check(code: &str, page: &str, plan: &Example) -> Result<(), String> {
    if WITHOUT_EXAMPLE.iter().any(|(known, _)| *known == code) {
        return Ok(());
    }
    let place = format!("docs/errors/{code}.md");
    let wrong = Example::of(page, "Wrong");
    let right = Example::of(page, "Right");
    if right.is_empty() {
        return Err(format!("{place}: no example under `## Right`"));
    }
    let shared = if wrong.has_plan() { plan.clone() } else { Example::default() };
    let wrong = wrong.with_defaults_of(&shared);
    let right = right.with_defaults_of(&wrong);
    let ended = wrong.run();
    let is_followed = FOLLOWED.iter().any(|(known, _)| *known == code);
    if !ended.codes.contains(code) || ended.codes.len() > 1 && !is_followed {
        return Err(format!(
            "{place}: the wrong example reports {:?}\n{}",
            ended.codes, ended.said
        ));
    }
    let ended = right.run();
    if !ended.codes.is_empty() || !ended.succeeded {
        return Err(format!("{place}: the right example is not accepted\n{}", ended.said));
    }
    Ok(())
}

/// Files and the commands that use them.
#[derive(Clone, Default)]
struct Example {
    files: BTreeMap<String, String>,
    commands: String,
}

/// The outcome of an example.
struct Ended {
    codes: BTreeSet<String>,
    succeeded: bool,
    /// The output of the commands.
    said: String,
}

impl Example {
    /// The example of the section `## HEADING` of a page.
    fn of(page: &str, heading: &str) -> Example {
        let mut example = Example::default();
        let section = page.split("\n## ").find_map(|s| s.strip_prefix(heading)).unwrap_or_default();
        let mut before = "";
        let mut lines = section.lines();
        while let Some(line) = lines.next() {
            if let Some(language) = line.strip_prefix("```") {
                let code: String = lines
                    .by_ref()
                    .take_while(|l| *l != "```")
                    .map(|l| l.to_owned() + "\n")
                    .collect();
                let name = before.strip_prefix('`').and_then(|b| b.strip_suffix("`:"));
                match (name, language) {
                    (Some(name), _) => _ = example.files.insert(name.to_owned(), code),
                    (None, "modelica") => _ = example.files.insert(MODEL.to_owned(), code),
                    (None, "sh") => example.commands += &code,
                    (None, other) => panic!("a fence `{other}` needs the name of a file:\n{code}"),
                }
                before = "";
            } else if !line.is_empty() {
                before = line;
            }
        }
        example
    }

    fn is_empty(&self) -> bool {
        self.files.is_empty() && self.commands.is_empty()
    }

    /// This example, with the files and commands of another one that it does not replace.
    fn with_defaults_of(mut self, other: &Example) -> Example {
        for (name, text) in &other.files {
            self.files.entry(name.clone()).or_insert_with(|| text.clone());
        }
        if self.commands.is_empty() {
            self.commands.clone_from(&other.commands);
        }
        self
    }

    /// Whether it uses a plan, and with it the model and the recording of all plans.
    fn has_plan(&self) -> bool {
        self.files.contains_key(PLAN) || self.commands.contains(PLAN)
    }

    fn run(&self) -> Ended {
        let folder = Scratch::new();
        for (name, text) in &self.files {
            let path = folder.file(name, text);
            if name == "runtime.so" {
                // What looks like a library with the functions of FMI is not a text.
                fs::write(path, STAND_IN).expect("a file");
            }
        }
        match self.commands.as_str() {
            "" if self.files.contains_key(PLAN) => shell(folder.path(), "mocc calibrate plan.toml"),
            "" => check_in_process(&folder.path().join(MODEL)),
            commands => shell(folder.path(), commands),
        }
    }
}

/// `mocc check` without a process.
fn check_in_process(file: &Path) -> Ended {
    let mut session = Session::default();
    let request = Request::new(Some(file.to_owned()), None);
    let checked = session.check(&request, mocc::base::diag::Severity::Warning);
    let problems = session.problems.sorted();
    Ended {
        codes: problems.iter().map(|d| d.code.to_owned()).collect(),
        succeeded: checked.is_ok(),
        said: problems.iter().map(|d| format!("{}: {}\n", d.code, d.message)).collect(),
    }
}

/// Runs commands in a folder, until one fails.
fn shell(folder: &Path, commands: &str) -> Ended {
    let program = Path::new(env!("CARGO_BIN_EXE_mocc")).parent().expect("a folder");
    let path = std::env::var_os("PATH").unwrap_or_default();
    let all = std::iter::once(program.to_owned()).chain(std::env::split_paths(&path));
    let output = Command::new("sh")
        .args(["-ec", commands])
        .current_dir(folder)
        .env("PATH", std::env::join_paths(all).expect("folders without `:`"))
        .env_remove("MODELICAPATH")
        .output()
        .expect("sh starts");
    let said = String::from_utf8(output.stdout).expect("UTF-8")
        + &String::from_utf8(output.stderr).expect("UTF-8");
    let code = |line: &str| {
        let rest = line.strip_prefix("error[").or_else(|| line.strip_prefix("warning["))?;
        Some(rest.split(']').next()?.to_owned())
    };
    Ended {
        codes: said.lines().filter_map(code).collect(),
        succeeded: output.status.success(),
        said,
    }
}

// ---- The pages ----

#[test]
fn every_code_has_a_page() {
    let pages: BTreeSet<String> = pages().into_keys().collect();
    let codes = codes();
    let missing: Vec<_> = codes.difference(&pages).collect();
    assert!(missing.is_empty(), "docs/errors/ has no pages for {missing:?}");
    let idle: Vec<_> = pages.difference(&codes).collect();
    assert!(
        idle.is_empty(),
        "docs/errors/ has pages for {idle:?}, which the program never reports"
    );
    let unknown: Vec<_> =
        WITHOUT_EXAMPLE.iter().map(|(code, _)| *code).filter(|c| !codes.contains(*c)).collect();
    assert!(unknown.is_empty(), "{unknown:?} are exceptions, but not codes");
}

#[test]
fn pages_have_one_form() {
    for (code, page) in pages() {
        let place = format!("docs/errors/{code}.md");
        let summary = page.strip_prefix(&format!("# {code}: ")).unwrap_or_default();
        let summary = summary.lines().next().unwrap_or_default();
        assert!(!summary.is_empty(), "{place}: expected the heading `# {code}: SUMMARY`");
        assert!(!summary.ends_with('.'), "{place}: the heading ends with a full stop");
        let headings: Vec<&str> = page.lines().filter(|l| l.starts_with("## ")).collect();
        let has_example = !WITHOUT_EXAMPLE.iter().any(|(known, _)| *known == code);
        let is_usual = headings == ["## Wrong", "## Right"];
        assert!(is_usual || !has_example && headings.is_empty(), "{place}: sections {headings:?}");
    }
}

#[test]
fn lists_of_pages_are_up_to_date() {
    let pages = pages();
    let mut stale = Vec::new();
    for (path, text) in [
        ("docs/errors/README.md", index(&read("docs/errors/README.md"), &pages)),
        ("docs/SUMMARY.md", contents(&read("docs/SUMMARY.md"), &pages)),
    ] {
        if std::env::var_os("DOCS_UPDATE").is_some() {
            fs::write(root().join(path), text).expect("a page");
        } else if read(path) != text {
            stale.push(path);
        }
    }
    let cure = "DOCS_UPDATE=1 cargo test --test all errors";
    assert!(stale.is_empty(), "{} differ from docs/errors/; run {cure}", stale.join(", "));
}

/// The index, with its lists by group.
fn index(old: &str, pages: &BTreeMap<String, String>) -> String {
    const MARK: &str = "<!-- Generated below. -->\n";
    let (written, _) = old.split_once(MARK).expect("the mark above the lists");
    let mut out = format!("{written}{MARK}");
    let mut listed = 0;
    for (title, ranges) in GROUPS {
        let mut own = pages.iter().filter(|(code, _)| ranges.contains(&&code[2..4])).peekable();
        if own.peek().is_some() {
            write!(out, "\n## {title}\n\n").expect("a String");
        }
        for (code, page) in own {
            listed += 1;
            writeln!(out, "- [{code}]({code}.md): {}", summary(page)).expect("a String");
        }
    }
    assert_eq!(listed, pages.len(), "a code is in none of the groups of this test");
    out
}

/// The table of contents of the book, with the pages under their index.
fn contents(old: &str, pages: &BTreeMap<String, String>) -> String {
    let mut out = String::new();
    let mut inside = false;
    for line in old.lines() {
        inside &= line.starts_with("  ");
        if !inside {
            out += line;
            out.push('\n');
        }
        if line.contains("(errors/README.md)") {
            inside = true;
            for (code, page) in pages {
                let summary = summary(page);
                writeln!(out, "  - [{code}: {summary}](errors/{code}.md)").expect("a String");
            }
        }
    }
    out
}

/// The heading of a page without its code.
fn summary(page: &str) -> &str {
    page.lines().next().and_then(|heading| heading.split_once(": ")).expect("a heading").1
}

// ---- The command ----

#[test]
fn the_command_prints_the_pages() {
    let folder = Scratch::new();
    let explained = mocc(folder.path(), &["explain", "MO0402"]);
    assert_eq!((explained.status, explained.err.as_str()), (0, ""));
    insta::assert_snapshot!(explained.out);
    for spelling in ["mo0402", "402", "0402"] {
        assert_eq!(mocc(folder.path(), &["explain", spelling]).out, explained.out, "{spelling}");
    }
    let list = mocc(folder.path(), &["explain"]).out;
    for (code, page) in pages() {
        assert!(list.contains(&format!("{code}  {}\n", summary(&page))), "{code}: {list}");
    }
}

#[test]
fn an_unknown_code_is_a_usage_error() {
    let folder = Scratch::new();
    let near = mocc(folder.path(), &["explain", "MO0404x"]);
    assert_eq!((near.status, near.out.as_str()), (2, ""));
    assert!(
        near.err.starts_with("error: `MO0404x` is not a code of a diagnostic\n"),
        "{}",
        near.err
    );
    let unknown = mocc(folder.path(), &["explain", "499"]);
    assert_eq!((unknown.status, unknown.out.as_str()), (2, ""));
    assert!(unknown.err.starts_with("error: there is no diagnostic `MO0499`\n"), "{}", unknown.err);
    assert!(unknown.err.contains("\n  MO0409  "), "{}", unknown.err);
}

/// The hint is for terminals: the output of a pipe stays as it is.
#[test]
fn a_pipe_gets_no_hint() {
    let folder = Scratch::new();
    folder.file("model.mo", "model A\n  Real x = y;\nend A;\n");
    let ended = mocc(folder.path(), &["check", "model.mo"]);
    assert!(
        ended.err.contains("error[MO0202]") && !ended.err.contains("mocc explain"),
        "{}",
        ended.err
    );
}

// ---- Files ----

/// The pages by code. Those in the binary are those on disk.
fn pages() -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(root().join("docs/errors")).expect("the pages").flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if let Some(code) = name.strip_suffix(".md").filter(|code| *code != "README") {
            found.insert(code.to_owned(), fs::read_to_string(entry.path()).expect("a page"));
        }
    }
    let embedded = error_pages().into_iter().map(|(code, page)| (code.to_owned(), page.to_owned()));
    assert!(
        found == embedded.collect::<BTreeMap<_, _>>(),
        "the binary has other pages than docs/errors/"
    );
    found
}

/// The codes of the program.
fn codes() -> BTreeSet<String> {
    mocc::registry::entries().map(|entry| entry.code.to_owned()).collect()
}

fn read(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|why| panic!("{path}: {why}"))
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}
