//! Versions of libraries: which one a text asks for, and which one a folder holds (sections 13.4 and 18.8 of
//! the specification).

use std::cmp::Ordering;
use std::sync::Arc;

use crate::base::name::{Name, name};
use crate::base::source::Span;
use crate::ir::ast::{ArgumentKind, Class, ExprKind, Modification};

/// An entry of `annotation(uses(Library(version = "...")))`.
#[derive(Clone, Debug)]
pub struct Use {
    /// The library.
    pub library: Name,
    /// Its version.
    pub version: Arc<str>,
    /// Where that is written.
    pub span: Span,
}

/// What the annotation of a class says of the libraries that it uses.
pub fn uses(class: &Class) -> Vec<Use> {
    let Some(annotation) = &class.annotation else { return Vec::new() };
    let lists = elements(annotation).filter(|(what, _)| what == "uses").map(|(_, list)| list);
    let entries = lists.flat_map(elements);
    let of = |(library, entry): (String, &Modification)| {
        let (version, span) = text(entry, "version")?;
        Some(Use { library: name(&library), version, span })
    };
    entries.filter_map(of).collect()
}

/// The version that a library says it has.
pub fn of(class: &Class) -> Option<Arc<str>> {
    class.annotation.as_ref().and_then(|a| text(a, "version")).map(|(version, _)| version)
}

/// Whether what was written for a version needs no change: `conversion(noneFromVersion = "...")`.
pub fn serves(class: &Class, version: &str) -> bool {
    let Some(annotation) = &class.annotation else { return false };
    let lists = elements(annotation).filter(|(what, _)| what == "conversion");
    let mut entries = lists.flat_map(|(_, list)| elements(list));
    entries.any(|(what, m)| {
        what == "noneFromVersion" && string(m).is_some_and(|(text, _)| &*text == version)
    })
}

/// The version in the name of a folder or file, empty where it has none; `None` if it is not of the library.
pub fn of_entry<'e>(entry: &'e str, library: &str) -> Option<&'e str> {
    let stem = entry.strip_suffix('/').or_else(|| entry.strip_suffix(".mo"))?;
    let rest = stem.strip_prefix(library)?;
    if rest.is_empty() { Some("") } else { rest.strip_prefix(' ') }
}

/// Versions by their numbers, from old to new.
pub fn order(a: &str, b: &str) -> Ordering {
    let numbers = |v: &str| -> Vec<u64> {
        v.split(|c: char| !c.is_ascii_digit()).filter_map(|n| n.parse().ok()).collect()
    };
    numbers(a).cmp(&numbers(b)).then_with(|| a.cmp(b))
}

fn elements(m: &Modification) -> impl Iterator<Item = (String, &Modification)> {
    m.args.iter().filter_map(|arg| match &arg.kind {
        ArgumentKind::Element { path, modification: Some(inner), .. } => {
            Some((path.to_string(), &**inner))
        }
        _ => None,
    })
}

fn text(m: &Modification, wanted: &str) -> Option<(Arc<str>, Span)> {
    elements(m).find(|(what, _)| what == wanted).and_then(|(_, inner)| string(inner))
}

fn string(m: &Modification) -> Option<(Arc<str>, Span)> {
    let value = m.binding.as_ref()?;
    match &value.kind {
        ExprKind::String(text) => Some((text.clone(), value.span)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_numbers() {
        assert_eq!(order("4.1.0", "4.0.10"), Ordering::Greater);
        assert_eq!(order("10.0", "9.9.9"), Ordering::Greater);
        assert_eq!(of_entry("Modelica 4.1.0/", "Modelica"), Some("4.1.0"));
        assert_eq!(of_entry("Modelica 4.1.0.mo", "Modelica"), Some("4.1.0"));
        assert_eq!(of_entry("Modelica/", "Modelica"), Some(""));
        assert_eq!(of_entry("ModelicaServices/", "Modelica"), None);
        assert_eq!(of_entry("Modelica.txt", "Modelica"), None);
    }
}
