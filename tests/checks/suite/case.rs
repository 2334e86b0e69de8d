//! Files of the suite: named cases, each a model and what is expected of it. `tests/suite/README.md`
//! describes the format.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::directive::{self, Claim, Directive, Options, Verb};
use super::formula::Function;

/// One named case.
pub struct TestCase {
    /// The file, from the root of the repository.
    pub file: String,
    pub stage: String,
    pub topic: String,
    pub name: String,
    /// The line of its head.
    pub line: usize,
    /// The model without directives.
    pub model: String,
    /// For each line of the model its line in the file.
    pub lines: Vec<usize>,
    pub problems: Vec<Problem>,
    pub status: i32,
    pub runs: Vec<Run>,
    pub functions: BTreeMap<String, Function>,
    pub shows_flat: bool,
    pub shows_structure: bool,
    /// Files of `tests/checks` that read the model.
    pub readers: Vec<String>,
}

/// An expected error or warning.
pub struct Problem {
    /// The line of the directive.
    pub line: usize,
    /// `error[MO0312] 17:6-8`, with the line in the file; `error[MO0912] lib/A.mo:3:4-9`; or without a place.
    pub shown: String,
    pub message: Option<String>,
}

/// One run, and what is expected of it.
pub struct Run {
    pub verb: Verb,
    pub options: Options,
    /// With their lines.
    pub claims: Vec<(usize, Claim)>,
}

impl TestCase {
    /// `stage/topic/name`.
    pub fn full_name(&self) -> String {
        format!("{}/{}/{}", self.stage, self.topic, self.name)
    }
    /// How many expectations it states; a snapshot is one.
    pub fn expectations(&self) -> usize {
        let claims: usize = self.runs.iter().map(|r| r.claims.len()).sum();
        let shown = [!self.problems.is_empty(), self.shows_flat, self.shows_structure];
        self.problems.len() + claims + shown.into_iter().filter(|s| *s).count()
    }
    /// Whether the suite runs it itself.
    pub fn is_run(&self) -> bool {
        self.readers.is_empty() || self.expectations() > 0
    }

    fn add(
        &mut self,
        line: usize,
        directive: Directive,
        next: Option<usize>,
    ) -> Result<(), String> {
        match directive {
            Directive::Run(verb, options) => match self.runs.as_mut_slice() {
                [only] if only.claims.is_empty() && !only.options.given => {
                    (only.verb, only.options) = (verb, options);
                }
                _ => self.runs.push(Run { verb, options, claims: Vec::new() }),
            },
            Directive::Status(status) => self.status = status,
            Directive::Problem { head, place, message } => {
                let shown = match place {
                    directive::Place::Columns(columns) => {
                        let line = next.ok_or("no line of the model follows")?;
                        format!("{head} {line}:{columns}")
                    }
                    directive::Place::At(place) => format!("{head} {place}"),
                    directive::Place::Nowhere => head,
                };
                self.problems.push(Problem { line, shown, message });
            }
            Directive::Expect(claim) => {
                let run = self.runs.last_mut().expect("a case has a run");
                run.claims.push((line, claim));
            }
            Directive::Let(name, function) => {
                if self.functions.insert(name.clone(), function).is_some() {
                    return Err(format!("`{name}` is defined twice"));
                }
            }
            Directive::Snapshot { flat, structure } => {
                self.shows_flat |= flat;
                self.shows_structure |= structure;
            }
            Directive::UsedBy(reader) => self.readers.push(reader),
        }
        Ok(())
    }
}

/// The root of the repository.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The folders of the suite, sorted.
pub fn stages() -> Vec<String> {
    names(&root().join("tests/suite"), |path| path.is_dir())
}

/// The cases of a stage in order of file and line. Malformed directives are errors.
pub fn cases(stage: &str) -> Result<Vec<TestCase>, String> {
    let folder = root().join("tests/suite").join(stage);
    let mut out = Vec::new();
    for file in names(&folder, |path| path.extension().is_some_and(|e| e == "mo")) {
        out.extend(read(stage, file.trim_end_matches(".mo"))?);
    }
    Ok(out)
}

fn names(folder: &Path, wanted: impl Fn(&PathBuf) -> bool) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|_| panic!("{}", folder.display()));
    let mut names: Vec<String> = entries
        .flatten()
        .filter(|e| wanted(&e.path()))
        .map(|e| e.file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// The cases of a file of the suite.
pub fn read(stage: &str, topic: &str) -> Result<Vec<TestCase>, String> {
    let file = format!("tests/suite/{stage}/{topic}.mo");
    let text = std::fs::read_to_string(root().join(&file)).map_err(|e| format!("{file}: {e}"))?;
    parse(&file, stage, topic, &text)
}

/// Takes a file apart.
fn parse(file: &str, stage: &str, topic: &str, text: &str) -> Result<Vec<TestCase>, String> {
    let mut cases: Vec<TestCase> = Vec::new();
    // Directives whose line of the model is still to come.
    let mut waiting: Vec<(usize, Directive)> = Vec::new();
    let mut continued: Option<(usize, String)> = None;
    for (k, text) in text.lines().enumerate() {
        let wrong = |line: usize, why: String| format!("{file}:{line}: {why}");
        let directive = match (text.trim_start().strip_prefix("//@"), continued.take()) {
            (Some(rest), None) => Some((k + 1, rest.trim().to_string())),
            (Some(rest), Some((line, before))) => Some((line, format!("{before} {}", rest.trim()))),
            (None, Some((line, _))) => return Err(wrong(line, "nothing follows `\\`".to_string())),
            (None, None) if text.contains("//@") => {
                return Err(wrong(k + 1, "a directive has its own line".to_string()));
            }
            (None, None) => None,
        };
        let Some((line, text)) = directive else {
            match cases.last_mut() {
                Some(case) => {
                    if !text.trim().is_empty() {
                        for (line, directive) in waiting.drain(..) {
                            case.add(line, directive, Some(k + 1)).map_err(|e| wrong(line, e))?;
                        }
                    }
                    case.model.push_str(text);
                    case.model.push('\n');
                    case.lines.push(k + 1);
                }
                None if text.trim().is_empty() || text.starts_with("//") => {}
                None => return Err(wrong(k + 1, "a model begins before a case".to_string())),
            }
            continue;
        };
        if let Some(begun) = text.strip_suffix('\\') {
            continued = Some((line, begun.trim_end().to_string()));
            continue;
        }
        if let Some(name) = text.strip_prefix("case ") {
            finish(cases.last_mut(), &mut waiting).map_err(|e| wrong(line, e))?;
            let name = name.trim();
            let good = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
            if name.is_empty() || !name.chars().all(good) {
                return Err(wrong(line, format!("`{name}` is not a name in snake case")));
            }
            if cases.iter().any(|c| c.name == name) {
                return Err(wrong(line, format!("there are two cases `{name}`")));
            }
            cases.push(TestCase {
                file: file.to_string(),
                stage: stage.to_string(),
                topic: topic.to_string(),
                name: name.to_string(),
                line,
                model: String::new(),
                lines: Vec::new(),
                problems: Vec::new(),
                status: 0,
                runs: vec![Run {
                    verb: Verb::Run,
                    options: Options::default(),
                    claims: Vec::new(),
                }],
                functions: BTreeMap::new(),
                shows_flat: false,
                shows_structure: false,
                readers: Vec::new(),
            });
            continue;
        }
        let Some(case) = cases.last_mut() else {
            return Err(wrong(line, "a directive is before the first case".to_string()));
        };
        let directive = directive::read(&text).map_err(|e| wrong(line, e))?;
        match directive {
            Directive::Problem { place: directive::Place::Columns(_), .. } => {
                waiting.push((line, directive));
            }
            _ => case.add(line, directive, None).map_err(|e| wrong(line, e))?,
        }
    }
    if let Some((line, _)) = continued {
        return Err(format!("{file}:{line}: nothing follows `\\`"));
    }
    finish(cases.last_mut(), &mut waiting).map_err(|e| format!("{file}: {e}"))?;
    match cases.is_empty() {
        true => Err(format!("{file}: the file has no case")),
        false => Ok(cases),
    }
}

/// Ends a case: without empty lines around its model, and with something that is expected.
fn finish(
    case: Option<&mut TestCase>,
    waiting: &mut Vec<(usize, Directive)>,
) -> Result<(), String> {
    let Some(case) = case else { return Ok(()) };
    for (line, directive) in waiting.drain(..) {
        case.add(line, directive, None)?;
    }
    let empty = case.model.lines().take_while(|l| l.trim().is_empty()).count();
    case.lines.drain(..empty);
    let model: String = case.model.lines().skip(empty).flat_map(|l| [l, "\n"]).collect();
    case.model = format!("{}\n", model.trim_end());
    if case.model.trim().is_empty() {
        return Err(format!("the case `{}` has no model", case.name));
    }
    if case.expectations() == 0 && case.readers.is_empty() {
        return Err(format!("the case `{}` expects nothing", case.name));
    }
    let errors = case.problems.iter().any(|p| p.shown.starts_with("error"));
    case.status = match case.status {
        0 if errors => 1,
        status => status,
    };
    Ok(())
}

#[test]
fn malformed_files_are_refused_with_their_line() {
    let model = "model M\n  Real x = 1;\nend M;\n";
    for (text, why) in [
        (format!("//@ case m\n{model}//@ expext x = 1\n"), ":5: unknown directive `expext`"),
        (format!("//@ case m\n{model}//@ expect x 1\n"), ":5: a relation is missing"),
        (format!("//@ case m\n{model}//@ expect x = 1 within 2\n"), ":5: "),
        (format!("//@ case m\n//@ run stp=1\n{model}"), ":2: unknown option `stp`"),
        (format!("//@ case m\n//@ snapshot block\n{model}"), ":2: "),
        (format!("//@ case m\n{model}"), "the case `m` expects nothing"),
        (format!("//@ case m\n{model}//@ error[MO0001] 3\n"), "no line of the model follows"),
        (format!("//@ case m\n{model}//@ expect x = 1\n//@ case m\n{model}"), ":6: there are two"),
        (format!("//@ case M m\n{model}"), ":1: `M m` is not a name"),
        (format!("{model}//@ case m\n"), ":1: a model begins before a case"),
        ("//@ case m\nmodel M //@ expect x = 1\n".to_string(), ":2: a directive has its own line"),
        ("//@ case m\n//@ expect accepted\n".to_string(), "the case `m` has no model"),
        (format!("//@ case m\n{model}//@ expect x = \\\n"), ":5: nothing follows"),
        ("// nothing\n".to_string(), "the file has no case"),
    ] {
        let found = parse("f.mo", "s", "f", &text).err().unwrap_or_default();
        assert!(found.starts_with("f.mo:") && found.contains(why), "{found} instead of {why}");
    }
    let two = format!(
        "// Head.\n//@ case one\n\n// Why.\n{model}\n//@ expect x = 1\n//@ case two\nmodel M\n  //@ error[MO0201] 3-6\n  Reel x;\nend M;"
    );
    let cases = parse("f.mo", "s", "f", &two).expect("well formed");
    assert_eq!(cases[0].model, format!("// Why.\n{model}"));
    assert_eq!(cases[0].lines[..2], [4, 5]);
    assert_eq!(cases[1].model, "model M\n  Reel x;\nend M;\n");
    assert_eq!((cases[1].problems[0].shown.as_str(), cases[1].status), ("error[MO0201] 13:3-6", 1));
}
