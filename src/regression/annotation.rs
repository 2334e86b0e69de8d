//! Reads the tests in the annotations of models: `annotation(__mocc(tests(opens(traces = true))))`.
//!
//! The keys are those of a test file; the name of a test is the model's with that of the test.

use std::path::Path;

use super::test_file::{Subject, TEST, Test, add_runs, tolerances};
use crate::base::diag::{Diagnostic, Problems, did_you_mean};
use crate::base::document::Section;
use crate::base::source::SourceMap;
use crate::base::toml_file::{Reader, TomlCause, read_table};
use crate::driver::annotation_table::of_file;

/// Whether a source may hold tests.
pub fn may_hold_tests(source: &str) -> bool {
    source.split_once("__mocc").is_some_and(|(_, rest)| rest.contains("test"))
}

/// Reads the tests of a source. None if it has errors, which are added to `problems`.
///
/// Errors of syntax are those of the tests, unless no test can be read.
pub fn read(
    path: &Path,
    text: &str,
    sources: &mut SourceMap,
    problems: &mut Problems,
) -> Option<Vec<Test>> {
    let (tables, syntax) = of_file(path, text, sources);
    let mut out = Vec::new();
    let mut is_valid = true;
    for (class, table) in &tables {
        let read = read_table(table, problems, |r, root| tests(r, &root, path, class, &mut out));
        is_valid &= read.is_some();
    }
    if out.is_empty() && is_valid && syntax.has_errors() {
        problems.extend(syntax);
        return None;
    }
    is_valid.then_some(out)
}

fn tests(r: &mut Reader<'_>, root: &Section<'_>, path: &Path, class: &str, out: &mut Vec<Test>) {
    if root.get("tests").is_none() {
        // Other entries are about other things, but for a slip of the pen.
        let slip = root.keys().find(|(key, _)| did_you_mean(key, ["tests"]).is_some());
        if let Some((key, span)) = slip {
            let (key, known) = (key.to_owned(), "tests".to_owned());
            let cause = TomlCause::UnknownKey { key, near: Some(known.clone()), known };
            r.report(Diagnostic::new(cause, span));
        }
        return;
    }
    let general = tolerances(r, root);
    for (name, section) in r.tables(root, "tests", "a test `NAME(...)`") {
        r.known(&section, &TEST);
        let subject = Subject {
            file: path,
            model: Some(path.to_owned()),
            model_name: Some(class.to_owned()),
            libraries: Vec::new(),
        };
        add_runs(r, &section, format!("{class}.{name}"), subject, general, out);
    }
}
