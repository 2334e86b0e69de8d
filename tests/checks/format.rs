//! `mocc fmt`: order, and nothing else.

use std::path::Path;

use mocc::base::source::FileId;
use mocc::format::format;

use super::door::{Case, Scratch, suite_model};
use super::program::mocc;
use super::suite::case::{cases, stages};

/// Examples, libraries and models of the suite, with their names.
fn sources() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut folders = ["examples", "lib"].map(|f| root.join(f)).to_vec();
    let mut found = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder").flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "mo" || e == "mol") {
                let name = path.strip_prefix(root).expect("below the root").to_string_lossy();
                let text = std::fs::read_to_string(&path).expect("a model");
                found.push((name.replace('\\', "/"), text));
            }
        }
    }
    found.sort();
    for stage in stages() {
        let cases = cases(&stage).unwrap_or_else(|why| panic!("{why}"));
        found.extend(cases.into_iter().map(|c| (c.full_name(), c.model)));
    }
    found
}

fn ordered(text: &str) -> Option<String> {
    format(FileId(0), text).ok()
}

#[test]
fn a_formatted_text_stays_as_it_is() {
    let mut count = 0;
    for (name, text) in sources() {
        let Some(once) = ordered(&text) else { continue };
        assert_eq!(ordered(&once).as_deref(), Some(once.as_str()), "{name}");
        count += 1;
    }
    assert!(count > 150, "{count}");
}

#[test]
fn all_forms() {
    let once = ordered(&suite_model("format/forms/all_forms")).expect("no syntax errors");
    insta::assert_snapshot!("all_forms", once);
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
    // Examples and models that are to be flattened; the others have no meaning, or need their package.
    let cases = cases("flatten").unwrap_or_else(|why| panic!("{why}"));
    let flat = cases.into_iter().filter(|c| c.shows_flat).map(|c| (c.full_name(), c.model));
    let examples = sources().into_iter().filter(|(name, _)| name.starts_with("examples/"));
    for (name, text) in examples.chain(flat) {
        let once = ordered(&text).expect("no syntax errors");
        assert_eq!(Case::text(&once).flat(), Case::text(&text).flat(), "{name}");
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
