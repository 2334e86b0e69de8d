//! `mocc fmt`: order, and nothing else.

use std::path::{Path, PathBuf};

use mocc::base::source::FileId;
use mocc::format::format;

use super::door::{Case, Scratch, text_of};
use super::program::mocc;

/// Files with texts of models.
fn texts() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut folders = ["examples", "lib", "tests/suite"].map(|f| root.join(f)).to_vec();
    let mut found = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder").flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "mo" || e == "mol") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

fn ordered(text: &str) -> Option<String> {
    format(FileId(0), text).ok()
}

#[test]
fn a_formatted_text_stays_as_it_is() {
    let mut count = 0;
    for path in texts() {
        let text = std::fs::read_to_string(&path).expect("a text");
        let Some(once) = ordered(&text) else { continue };
        assert_eq!(ordered(&once).as_deref(), Some(once.as_str()), "{}", path.display());
        count += 1;
    }
    assert!(count > 150, "{count}");
}

#[test]
fn all_forms() {
    let text = text_of("tests/suite/format/forms.mo");
    let once = ordered(&text).expect("no syntax errors");
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("../suite/format");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!("forms", once));
    // Indentation destroyed is indentation restored.
    let flush: String = once.lines().map(|l| format!("{}\n", l.trim_start())).collect();
    let again = ordered(&flush).expect("the same tokens");
    for (a, b) in once.lines().zip(again.lines()) {
        assert_eq!(a.trim(), b.trim());
    }
}

#[test]
fn the_meaning_stays() {
    let mut compared = 0;
    for path in texts() {
        let text = std::fs::read_to_string(&path).expect("a text");
        // Examples and models that are to be flattened; the others have no meaning, or need their package.
        let shown = path.to_string_lossy().replace('\\', "/");
        if !(shown.contains("/examples/") || shown.contains("/suite/flatten/")) {
            continue;
        }
        let once = ordered(&text).expect("no syntax errors");
        assert_eq!(Case::text(&once).flat(), Case::text(&text).flat(), "{shown}");
        compared += 1;
    }
    assert!(compared >= 15, "{compared}");
}

#[test]
fn files_are_changed_in_place_or_named() {
    let scratch = Scratch::new();
    let text = "model M\nReal x=1;\nend M;\n";
    let path = scratch.file("m.mo", text);
    let name = path.to_str().expect("UTF-8");
    let checked = mocc(scratch.path(), &["fmt", "--check", name]);
    assert_eq!((checked.status, checked.out.trim()), (1, name));
    assert_eq!(std::fs::read_to_string(&path).expect("still there"), text);
    assert_eq!(mocc(scratch.path(), &["fmt", name]).status, 0);
    let after = std::fs::read_to_string(&path).expect("still there");
    assert_eq!(after, "model M\n  Real x = 1;\nend M;\n");
    assert_eq!(mocc(scratch.path(), &["fmt", "--check", name]).status, 0);
    let broken = scratch.file("b.mo", "model B\n  Real x = ;\nend B;\n");
    let ended = mocc(scratch.path(), &["fmt", broken.to_str().expect("UTF-8")]);
    assert_eq!(ended.status, 1);
    assert!(ended.err.contains("MO0001"), "{}", ended.err);
}
