//! The pages of `docs/library/` are those that `mocc doc` makes of the library.
//!
//! After a change of the library, `DOCS_UPDATE=1 cargo test --test all library` writes the pages again.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use super::door::Scratch;
use super::program::mocc;

#[test]
fn library_pages_are_up_to_date() {
    let folder = root().join("docs/library");
    let scratch = Scratch::new();
    let pictures = scratch.path().join("pictures");
    fs::create_dir_all(&pictures).expect("a folder");
    for name in pictures_of(&folder) {
        fs::copy(folder.join("pictures").join(&name), pictures.join(&name)).expect("a copy");
    }
    let ended = mocc(scratch.path(), &["doc", "--format", "markdown", "--output", "."]);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    if std::env::var_os("DOCS_UPDATE").is_some() {
        for (name, text) in pages(&folder) {
            drop(text);
            fs::remove_file(folder.join(name)).expect("an old page");
        }
        for (name, text) in pages(scratch.path()) {
            let path = folder.join(name);
            fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            fs::write(path, text).expect("a page");
        }
    }
    let (made, kept) = (pages(scratch.path()), pages(&folder));
    let names = made.keys().chain(kept.keys());
    let mut stale: Vec<&String> = names.filter(|name| made.get(*name) != kept.get(*name)).collect();
    stale.dedup();
    let cure = "DOCS_UPDATE=1 cargo test --test all library";
    assert!(stale.is_empty(), "{stale:?} differ from lib/; run {cure}");
}

/// The page of an effect shows its formula, what it explains, its parameters with units, and where it is used.
#[test]
fn pages_hold_what_the_sources_say() {
    let page = fs::read_to_string(root().join("docs/library/Effects.md")).expect("a page");
    let drag = page.split("\n## ").find(|s| s.starts_with("ViscousDrag\n")).expect("a section");
    for part in [
        "*model.* Damping proportional to the speed.",
        "```text\nf = -d v\n```",
        "Extends [`PartialDrag`](Effects.md#partialdrag).",
        "| `d` | [`Units.DampingCoefficient`](Units.md) | `0` | `N.s/m` | Damping coefficient |",
        "```modelica\nequation\n  f = -d*v;\n```",
        "Diagnosis: \"*component* is damped in proportion to its speed.\"",
        "![Damping proportional to the speed](pictures/Effects.ViscousDrag.svg)",
    ] {
        assert!(drag.contains(part), "no `{part}` in\n{drag}");
    }
    let page = fs::read_to_string(root().join("docs/library/Seals.md")).expect("a page");
    assert!(page.contains("`CloseOnly`: touches it over the whole stroke"), "{page}");
    assert!(page.contains("![Components of Seals.SingleSeal](diagrams/Seals.SingleSeal.svg)"));
    // A parameter of a base, with the value that the class gives it.
    assert!(page.contains("| `contact` | [`Contact`](Seals.md) |"), "{page}");
}

#[test]
fn every_effect_has_a_formula() {
    let page = fs::read_to_string(root().join("docs/library/Effects.md")).expect("a page");
    let effects = page.split("\n## ").filter(|section| section.contains("\nAnnotation: `"));
    let mut count = 0;
    for effect in effects {
        let name = effect.lines().next().unwrap_or_default();
        assert!(
            effect.contains("\n```text\n"),
            "lib/Effects/{name}.mo: no indented formula in the comment at its head"
        );
        count += 1;
    }
    assert!(count > 20, "{count} effects");
}

/// The models of the pictures compile, and every picture belongs to a class.
#[test]
fn pictures_belong_to_classes() {
    let folder = root().join("docs/library");
    let scratch = Scratch::new();
    let models = folder.join("pictures/pictures.mol").display().to_string();
    let ended = mocc(scratch.path(), &["check", &models]);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    let all: String = pages(&folder).into_values().collect();
    for name in pictures_of(&folder) {
        assert!(all.contains(&format!("](pictures/{name})")), "{name} belongs to no class of lib/");
    }
}

/// The pictures that are drawn by hand.
fn pictures_of(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder.join("pictures")).expect("pictures").flatten();
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    names.filter(|name| name.ends_with(".svg")).collect()
}

/// The pages in a folder and their diagrams, by their names.
fn pages(folder: &Path) -> BTreeMap<String, String> {
    let mut out = BTreeMap::new();
    for (inside, extension) in [("", "md"), ("diagrams", "svg")] {
        let Ok(entries) = fs::read_dir(folder.join(inside)) else { continue };
        for path in entries.flatten().map(|entry| entry.path()) {
            if path.extension().is_some_and(|e| e == extension) {
                let name = path.strip_prefix(folder).expect("inside").display().to_string();
                out.insert(name, fs::read_to_string(&path).expect("a page"));
            }
        }
    }
    out
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}
