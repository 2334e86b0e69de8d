//! Versions of libraries: the one that a class requires and the ones that a folder contains
//! (Modelica 3.6, sections 13.4 and 18.8).

use std::cmp::Ordering;
use std::sync::Arc;

use crate::base::name::{Name, name};
use crate::base::source::Span;
use crate::ir::ast::{ArgumentKind, Class, ExprKind, Modification};

/// An entry of `annotation(uses(Library(version = "...")))`.
#[derive(Clone, Debug)]
pub struct UsesEntry {
    /// The library.
    pub library: Name,
    /// The required version.
    pub version: Arc<str>,
    /// The span of the version string.
    pub span: Span,
}

/// The libraries that a class requires by its `uses` annotation.
pub fn uses(class: &Class) -> Vec<UsesEntry> {
    let Some(annotation) = &class.annotation else { return Vec::new() };
    let lists = elements(annotation).filter(|(name, _)| name == "uses").map(|(_, list)| list);
    let entries = lists.flat_map(elements);
    let of = |(library, entry): (String, &Modification)| {
        let (version, span) = text(entry, "version")?;
        Some(UsesEntry { library: name(&library), version, span })
    };
    entries.filter_map(of).collect()
}

/// The version in the annotation of a library.
pub fn declared_version(class: &Class) -> Option<Arc<str>> {
    class.annotation.as_ref().and_then(|a| text(a, "version")).map(|(version, _)| version)
}

/// True if models written for a version need no conversion: `conversion(noneFromVersion = "...")`.
pub fn is_compatible_with(class: &Class, version: &str) -> bool {
    let Some(annotation) = &class.annotation else { return false };
    let lists = elements(annotation).filter(|(name, _)| name == "conversion");
    let mut entries = lists.flat_map(|(_, list)| elements(list));
    entries.any(|(name, m)| {
        name == "noneFromVersion" && string(m).is_some_and(|(text, _)| &*text == version)
    })
}

/// The version in the name of a folder or file, empty if it has none; `None` if the name is not
/// that of the library.
pub fn of_entry<'e>(entry: &'e str, library: &str) -> Option<&'e str> {
    let stem = entry.strip_suffix('/').or_else(|| entry.strip_suffix(".mo"))?;
    let rest = stem.strip_prefix(library)?;
    if rest.is_empty() { Some("") } else { rest.strip_prefix(' ') }
}

/// Compares versions number by number, older first.
pub fn compare(a: &str, b: &str) -> Ordering {
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
    elements(m).find(|(name, _)| name == wanted).and_then(|(_, inner)| string(inner))
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
    fn versions_compare_by_number() {
        assert_eq!(compare("4.1.0", "4.0.10"), Ordering::Greater);
        assert_eq!(compare("10.0", "9.9.9"), Ordering::Greater);
        assert_eq!(of_entry("Modelica 4.1.0/", "Modelica"), Some("4.1.0"));
        assert_eq!(of_entry("Modelica 4.1.0.mo", "Modelica"), Some("4.1.0"));
        assert_eq!(of_entry("Modelica/", "Modelica"), Some(""));
        assert_eq!(of_entry("ModelicaServices/", "Modelica"), None);
        assert_eq!(of_entry("Modelica.txt", "Modelica"), None);
    }
}
