//! The documentation agrees with the program: the tutorial runs as printed, guide pages list the flags that exist, links
//! lead somewhere, and generated pages are up to date.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use super::door::Scratch;
use super::program::mocc;

// ---- The tutorial ----

/// A fenced block of a page, with the directive `<!-- ... -->` above it.
struct Block {
    line: usize,
    language: String,
    directive: String,
    text: String,
}

#[test]
fn the_tutorial_runs_as_printed() {
    let folder = Scratch::new();
    let page = read("docs/tutorial.md");
    copy(&root().join("docs/tutorial/recordings"), &folder.path().join("recordings"));
    let mut output = String::new();
    let mut commands = 0;
    for block in blocks(&page) {
        let place = format!("docs/tutorial.md:{}", block.line);
        if let Some(name) = block.directive.strip_prefix("file: ") {
            folder.file(name, &block.text);
            let kept = root().join("docs/tutorial").join(name);
            if kept.exists() {
                assert_eq!(fs::read_to_string(kept).ok(), Some(block.text), "{place}: {name}");
            }
        } else if let Some(name) = block.directive.strip_prefix("shows: ") {
            let all = fs::read_to_string(folder.path().join(name)).expect("a file that was shown");
            let start: Vec<&str> = all.lines().take(block.text.lines().count()).collect();
            agree(&block.text, &start.join("\n"), &place);
        } else if block.language == "sh" {
            if let Some(edit) = block.directive.strip_prefix("edit: ") {
                apply(edit, folder.path());
            }
            output.clear();
            for command in block.text.replace("\\\n", " ").lines() {
                let (command, status) = match command.split_once('#') {
                    Some((command, note)) => (command, i32::from(note.contains("status 1"))),
                    None => (command, 0),
                };
                let words = shell_words(command);
                assert_eq!(words[0], "mocc", "{place}: only mocc is run");
                let arguments: Vec<&str> = words[1..].iter().map(String::as_str).collect();
                let ended = mocc(folder.path(), &arguments);
                let said = ended.out + &ended.err;
                assert_eq!(ended.status, status, "{place}: {command}\n{said}");
                output += &said;
                commands += 1;
            }
        } else {
            assert_eq!(block.language, "text", "{place}: neither a file nor a command nor output");
            agree(&block.text, &output, &place);
        }
    }
    assert!(commands >= 8, "the tutorial shows only {commands} commands");
}

/// `A -> B: old -> new`: the file `B` is `A` with one replacement.
fn apply(edit: &str, folder: &Path) {
    let (files, change) = edit.split_once(": ").expect("files and a change");
    let (from, to) = files.split_once(" -> ").expect("two files");
    let (old, new) = change.split_once(" -> ").expect("old and new text");
    let text = fs::read_to_string(folder.join(from)).expect("the file to edit");
    assert_eq!(text.matches(old).count(), 1, "`{old}` in {from}");
    fs::write(folder.join(to), text.replace(old, new)).expect("the edited file");
}

/// Printed output agrees with real output: the same words, and numbers within 5 %. Counts and times of runs may differ; of
/// a diagnostic only the code and the place are compared.
fn agree(printed: &str, real: &str, place: &str) {
    // Excerpts of sources and notes are left to the tests of diagnostics.
    let is_fact = |line: &&str| {
        let rest = line.trim().trim_start_matches(|c: char| c.is_ascii_digit()).trim_start();
        !line.trim().is_empty() && !rest.starts_with(['|', '='])
    };
    let facts =
        |text: &str| -> Vec<String> { text.lines().filter(is_fact).map(str::to_owned).collect() };
    let (printed, real) = (facts(printed), facts(real));
    assert_eq!(printed.len(), real.len(), "{place}:\n{printed:#?}\n{real:#?}");
    for (p, r) in printed.iter().zip(&real) {
        if p.starts_with("error[") || p.starts_with("warning[") {
            assert_eq!(p.split(']').next(), r.split(']').next(), "{place}");
            continue;
        }
        let ((words, numbers), (real_words, real_numbers)) = (parts(p), parts(r));
        let costs = [" ms,", " steps", " a second"];
        let is_cost = words == "#s" || costs.iter().any(|cost| p.contains(cost));
        let near = |a: f64, b: f64| (a - b).abs() <= 0.05 * a.abs().max(b.abs());
        let same = numbers.len() == real_numbers.len()
            && numbers.iter().zip(&real_numbers).all(|(a, b)| is_cost || near(*a, *b));
        assert!(words == real_words && same, "{place}:\n{p}\n{r}");
    }
}

/// The words of a line without spaces, `#` for each number; and the numbers.
fn parts(line: &str) -> (String, Vec<f64>) {
    let (mut words, mut numbers) = (String::new(), Vec::new());
    let mut rest = line;
    while let Some(first) = rest.chars().next() {
        let before = line[..line.len() - rest.len()].chars().next_back();
        let after_word = before.is_some_and(|c| c.is_alphanumeric() || c == '_');
        let digits = rest.trim_start_matches('-');
        if digits.starts_with(|c: char| c.is_ascii_digit())
            && rest.len() - digits.len() < 2
            && !after_word
        {
            let is_part = |c: char| c.is_ascii_digit() || matches!(c, '.' | 'e' | '-' | '+');
            let mut end = rest.find(|c| !is_part(c)).unwrap_or(rest.len());
            while rest[..end].parse::<f64>().is_err() {
                end -= 1;
            }
            numbers.push(rest[..end].parse().expect("just parsed"));
            words.push('#');
            rest = &rest[end..];
        } else {
            words.extend(Some(first).filter(|c| !c.is_whitespace()));
            rest = &rest[first.len_utf8()..];
        }
    }
    (words, numbers)
}

/// The words of a command; double and single quotes hold words together.
fn shell_words(command: &str) -> Vec<String> {
    let (mut words, mut word, mut quote) = (Vec::new(), String::new(), None);
    for c in command.trim().chars().chain([' ']) {
        match quote {
            Some(q) if c == q => quote = None,
            Some(_) => word.push(c),
            None if c == '"' || c == '\'' => quote = Some(c),
            None if c == ' ' && word.is_empty() => {}
            None if c == ' ' => words.push(std::mem::take(&mut word)),
            None => word.push(c),
        }
    }
    words
}

fn blocks(page: &str) -> Vec<Block> {
    let mut found = Vec::new();
    let mut directive = String::new();
    let mut open: Option<Block> = None;
    for (k, line) in page.lines().enumerate() {
        if let Some(language) = line.strip_prefix("```") {
            match open.take() {
                Some(block) => found.push(block),
                None => {
                    open = Some(Block {
                        line: k + 1,
                        language: language.to_owned(),
                        directive: std::mem::take(&mut directive),
                        text: String::new(),
                    });
                }
            }
        } else if let Some(block) = &mut open {
            block.text += line;
            block.text.push('\n');
        } else if let Some(comment) = line.strip_prefix("<!-- ") {
            directive = comment.trim_end_matches(" -->").to_owned();
        }
    }
    found
}

#[test]
fn the_landing_page_stays_short_and_opens_with_the_two_commands() {
    let page = read("README.md");
    assert!(page.lines().count() <= 100, "README.md is a landing page; details belong in docs/");
    let commands = blocks(&page).into_iter().filter(|b| b.language == "sh").take(2);
    let first: Vec<String> = commands.map(|b| b.text).collect();
    let expected = [
        "pip install ./python\nmocc simulate examples/valve52.mol\n",
        "cargo run --release -- simulate examples/valve52.mol\ncargo test\n",
    ];
    assert_eq!(first, expected);
}

// ---- Guide pages ----

#[test]
fn guide_pages_list_the_flags_of_their_commands() {
    let folder = Scratch::new();
    let help = mocc(folder.path(), &["--help"]).out;
    let listed = help.lines().skip_while(|l| *l != "Commands:").skip(1);
    let commands = listed.take_while(|l| !l.is_empty());
    let names: Vec<&str> = commands.filter_map(|l| l.split_whitespace().next()).collect();
    assert!(names.contains(&"simulate") && names.len() > 8, "{help}");
    let mut broken = Vec::new();
    for name in names.into_iter().filter(|name| *name != "help") {
        // What can be exported has commands of its own.
        let help = match name {
            "export" => mocc(folder.path(), &[name, "fmu", "--help"]).out,
            _ => mocc(folder.path(), &[name, "--help"]).out,
        };
        let of_help: BTreeSet<&str> = help
            .lines()
            .filter_map(|line| {
                let line = line.trim_start();
                let long = line.strip_prefix("--");
                // `-o, --output <FILE>`
                long.or_else(|| line.strip_prefix('-')?.get(1..)?.strip_prefix(", --"))
            })
            .map(|line| line.split([' ', '[']).next().unwrap_or_default())
            .filter(|flag| *flag != "help")
            .collect();
        let path = format!("docs/guide/{name}.md");
        let Ok(page) = fs::read_to_string(root().join(&path)) else {
            broken.push(format!("{path} is missing"));
            continue;
        };
        let of_page: BTreeSet<&str> = page
            .lines()
            .filter_map(|line| line.strip_prefix("| `--"))
            .map(|line| line.split([' ', '`', '[']).next().unwrap_or_default())
            .collect();
        broken.extend(of_help.difference(&of_page).map(|f| format!("{path}: no row for --{f}")));
        broken.extend(of_page.difference(&of_help).map(|f| format!("{path}: --{f} is unknown")));
    }
    assert!(broken.is_empty(), "\n{}\n", broken.join("\n"));
}

#[test]
fn the_plan_page_lists_every_unit_and_key() {
    let page = read("docs/guide/plan.md");
    for name in mocc::calibrate::unit::Unit::names() {
        assert!(page.contains(&format!("`{name}`")), "docs/guide/plan.md does not list `{name}`");
    }
}

// ---- Links ----

#[test]
fn links_lead_somewhere() {
    let mut broken = Vec::new();
    for page in pages() {
        let text = read(&page);
        let folder = Path::new(&page).parent().unwrap_or(Path::new(""));
        for (line, target) in links(&text) {
            if target.contains("://") || target.starts_with("mailto:") {
                continue;
            }
            let (path, anchor) = target.split_once('#').unwrap_or((target, ""));
            let file = if path.is_empty() { PathBuf::from(&page) } else { folder.join(path) };
            if !root().join(&file).exists() {
                broken.push(format!("{page}:{line}: `{target}` does not exist"));
            } else if !anchor.is_empty() && !anchors(&read(&file)).contains(anchor) {
                broken.push(format!("{page}:{line}: `{target}`: no such heading"));
            }
        }
    }
    assert!(broken.is_empty(), "\n{}\n", broken.join("\n"));
}

#[test]
fn the_summary_lists_every_page() {
    let summary = read("docs/SUMMARY.md");
    let listed: BTreeSet<String> =
        links(&summary).into_iter().map(|(_, path)| format!("docs/{path}")).collect();
    let inside = pages().into_iter().filter(|p| p.starts_with("docs/") && *p != "docs/SUMMARY.md");
    let missing: Vec<String> = inside.filter(|page| !listed.contains(page)).collect();
    assert!(missing.is_empty(), "docs/SUMMARY.md does not list {}", missing.join(", "));
}

/// The targets of the links and pictures of a page, outside code.
fn links(page: &str) -> Vec<(usize, &str)> {
    let mut found = Vec::new();
    let mut fenced = false;
    for (k, line) in page.lines().enumerate() {
        fenced ^= line.starts_with("```");
        if fenced {
            continue;
        }
        for (at, _) in line.match_indices("](") {
            let target = line[at + 2..].split(')').next().unwrap_or_default();
            // Inside backquotes it is code.
            if line[..at].matches('`').count() % 2 == 0 {
                found.push((k + 1, target));
            }
        }
    }
    found
}

/// The anchors of a page's headings, as GitHub and mdBook name them.
fn anchors(page: &str) -> BTreeSet<String> {
    let headings = page.lines().filter(|l| l.starts_with('#'));
    headings
        .map(|heading| {
            let text = heading.trim_start_matches('#').trim().to_lowercase();
            let kept = text.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
            kept.map(|c| if c == ' ' { '-' } else { c }).collect()
        })
        .collect()
}

// ---- Files ----

/// All Markdown pages, relative to the root.
pub fn pages() -> Vec<String> {
    let mut found: Vec<String> =
        ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md"]
            .map(str::to_owned)
            .to_vec();
    let mut folders = ["docs", "examples", "grammar", "tests"].map(|f| root().join(f)).to_vec();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a folder of the project").flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "md") {
                let short = path.strip_prefix(root()).expect("a file of the project");
                found.push(short.to_string_lossy().replace('\\', "/"));
            }
        }
    }
    found.sort();
    found
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder");
    for entry in fs::read_dir(from).expect("a folder").flatten() {
        fs::copy(entry.path(), to.join(entry.file_name())).expect("a copy");
    }
}

fn read(path: impl AsRef<Path>) -> String {
    let path = root().join(path);
    fs::read_to_string(&path).unwrap_or_else(|why| panic!("{}: {why}", path.display()))
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}
