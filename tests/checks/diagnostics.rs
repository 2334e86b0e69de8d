//! Bad input: what mocc says to the models of `suite/diagnostics`, and with which exit status.
//!
//! Each file begins with what is expected: `// status: 1`, then `// error[MO0202] 6:17` for each error with its line
//! and column (`-` for none, the file before the place if it is another one), and `// args: ...` for options of the
//! command line. The snapshot holds the model and the message.

use std::fmt::Write;
use std::path::Path;

use super::door::Scratch;
use super::program::mocc;

const FOLDER: &str = "tests/suite/diagnostics";

#[test]
fn bad_models_are_refused_with_place_and_remedy() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let scratch = Scratch::new();
    let table = scratch.path().join("result.csv");
    let mut names: Vec<String> = std::fs::read_dir(root.join(FOLDER))
        .expect(FOLDER)
        .flatten()
        .map(|e| e.file_name().to_string_lossy().into_owned())
        .filter(|n| n.ends_with(".mo"))
        .collect();
    names.sort();
    assert!(names.len() >= 50);

    let mut wrong = String::new();
    for name in names {
        let path = format!("{FOLDER}/{name}");
        let text = std::fs::read_to_string(root.join(&path)).expect("a model");
        let options = said(&text, "// args: ").join(" ");
        let mut arguments = vec!["simulate", &path, "--output", table.to_str().expect("UTF-8")];
        arguments.extend(options.split_whitespace());
        let ended = mocc(root, &arguments);

        let expected_status = said(&text, "// status: ").join("");
        if ended.status.to_string() != expected_status {
            writeln!(wrong, "{name}: status {} instead of {expected_status}", ended.status)
                .expect("a String takes all");
        }
        let expected: Vec<String> = said(&text, "// error").iter().map(|e| e.to_string()).collect();
        let found = errors(&ended.err, &path);
        if found != expected {
            writeln!(wrong, "{name}: {found:#?} instead of {expected:#?}")
                .expect("a String takes all");
        }
        assert!(!table.exists(), "{name}: a failed run left a result");
        assert!(!ended.err.contains("a bug in mocc"), "{name}:\n{}", ended.err);

        let mut settings = insta::Settings::clone_current();
        settings.set_snapshot_path("../suite/diagnostics");
        settings.set_prepend_module_to_snapshot(false);
        settings.set_omit_expression(true);
        settings.bind(|| {
            let both = format!("{text}----\n{}", ended.err);
            insta::assert_snapshot!(name.trim_end_matches(".mo"), both);
        });
    }
    assert!(wrong.is_empty(), "{wrong}");
}

/// What follows a mark at the beginning of lines.
fn said<'a>(text: &'a str, mark: &str) -> Vec<&'a str> {
    text.lines().filter_map(|l| l.strip_prefix(mark)).map(str::trim).collect()
}

/// `[CODE] LINE:COLUMN` of each error in a rendered text.
fn errors(text: &str, path: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut lines = text.lines().peekable();
    while let Some(line) = lines.next() {
        let Some(rest) = line.strip_prefix("error") else { continue };
        let code = rest.split_inclusive(']').next().unwrap_or_default();
        let place = lines.peek().and_then(|l| l.trim_start().strip_prefix("--> "));
        let place = place.map(|p| p.strip_prefix(&format!("{path}:")).unwrap_or(p));
        found.push(format!("{code} {}", place.unwrap_or("-")));
    }
    found
}
