//! The sources of libraries, for people: which packages and classes there are, and their texts.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::compile::Request;
use super::files::{Shipped, folders};
use crate::base::diag::Problems;
use crate::base::source::SourceMap;
use crate::ir::ast::{Class, ClassBody, ClassKind, ElementKind};
use crate::parse::grammar::parse;
use crate::resolve::library::Folder;

/// A class of a library.
#[derive(Clone, PartialEq, Debug)]
pub struct Listed {
    /// Its full name.
    pub name: String,
    /// Its kind: `model`, `package`, `type`.
    pub kind: String,
    /// Its description string; may be empty.
    pub description: String,
    /// Number of the classes in it.
    pub classes: usize,
}

/// The source of a class.
#[derive(Clone, PartialEq, Debug)]
pub struct Shown {
    /// Its text.
    pub text: String,
    /// The file that it is in.
    pub path: PathBuf,
    /// Number of its first line.
    pub line: usize,
}

/// Sources in memory: names of files relative to their folder, and their texts.
pub type Sources = Vec<(PathBuf, Vec<u8>)>;

/// The classes in a package, or the packages of all folders if the name is empty. None if there is no such package.
pub fn list(request: &Request, package: &str) -> Option<Vec<Listed>> {
    let all = folders(request);
    let mut out: Vec<Listed> = Vec::new();
    if package.is_empty() {
        for folder in &all {
            for name in names(&**folder, Path::new("")) {
                if !out.iter().any(|known| known.name == name) {
                    out.extend(listed(&**folder, &name));
                }
            }
        }
        out.sort_by(|a, b| a.name.cmp(&b.name));
        return Some(out);
    }
    let path: PathBuf = package.split('.').collect();
    for folder in &all {
        let (class, _) = match class(&**folder, package) {
            Some(found) => found,
            None => continue,
        };
        let mut listed: Vec<Listed> =
            inside(&class).map(|c| entry(format!("{package}.{}", c.name.name), c)).collect();
        for name in names(&**folder, &path) {
            let full = format!("{package}.{name}");
            if !listed.iter().any(|known| known.name == full) {
                listed.extend(self::listed(&**folder, &full));
            }
        }
        return Some(listed);
    }
    None
}

/// A class with the text of its file, in which its spans are places.
#[derive(Clone, Debug)]
pub struct Parsed {
    /// Its full name.
    pub name: String,
    /// Its syntax tree.
    pub class: Arc<Class>,
    /// The text of its file.
    pub file: Arc<str>,
    /// The file, as messages show it.
    pub path: PathBuf,
}

/// A package with all classes in it, each before those inside; each file is read once. Empty without such a package.
pub fn tree(request: &Request, package: &str) -> Vec<Parsed> {
    let mut out = Vec::new();
    for folder in folders(request) {
        grow(&*folder, package, &mut out);
        if !out.is_empty() {
            break;
        }
    }
    out
}

fn grow(folder: &dyn Folder, full: &str, out: &mut Vec<Parsed>) {
    let stem: PathBuf = full.split('.').collect();
    let files = [stem.join("package.mo"), PathBuf::from(format!("{}.mo", stem.display()))];
    let found = files.into_iter().find_map(|p| Some((folder.read(&p)?.ok()?, p)));
    let Some((text, path)) = found else { return };
    parsed(&text, &folder.display(&path), full.rsplit_once('.').map_or("", |(p, _)| p), out);
    for name in names(folder, &stem) {
        let inner = format!("{full}.{name}");
        if !out.iter().any(|known| known.name == inner) {
            grow(folder, &inner, out);
        }
    }
}

/// The classes of a text, which stands in the package `within`.
pub fn parsed(text: &str, path: &Path, within: &str, out: &mut Vec<Parsed>) {
    let (mut sources, mut problems) = (SourceMap::default(), Problems::new());
    let id = sources.add(path, text);
    let file = parse(id, text, &mut problems);
    let text: Arc<str> = text.into();
    let mut open: Vec<(String, Arc<Class>)> =
        file.classes.iter().rev().map(|c| (within.to_owned(), Arc::clone(c))).collect();
    while let Some((within, class)) = open.pop() {
        let own = class.name.name.to_string();
        let name = if within.is_empty() { own } else { format!("{within}.{own}") };
        let inner: Vec<Arc<Class>> = inside(&class).cloned().collect();
        open.extend(inner.into_iter().rev().map(|c| (name.clone(), c)));
        out.push(Parsed { name, class, file: Arc::clone(&text), path: path.to_owned() });
    }
}

/// The source of a class by its full name.
pub fn show(request: &Request, name: &str) -> Option<Shown> {
    folders(request).iter().find_map(|folder| class(&**folder, name)).map(|(_, shown)| shown)
}

/// All files of the shipped library.
pub fn shipped() -> Sources {
    let mut out = Vec::new();
    let mut waiting = vec![PathBuf::new()];
    while let Some(folder) = waiting.pop() {
        for entry in Shipped.entries(&folder) {
            match entry.strip_suffix('/') {
                Some(name) => waiting.push(folder.join(name)),
                None => {
                    let path = folder.join(&entry);
                    if let Some(Ok(bytes)) = Shipped.data(&path) {
                        out.push((path, bytes));
                    }
                }
            }
        }
    }
    out.sort();
    out
}

/// Names of the classes that have a file or folder of their own, in the order that the package states (MLS 13.4.1).
fn names(folder: &dyn Folder, path: &Path) -> Vec<String> {
    let is_package = |name: &str| {
        let inside = path.join(name).join("package.mo");
        folder.read(&inside).is_some()
    };
    let entries = folder.entries(path);
    let name = |entry: &String| match entry.strip_suffix('/') {
        Some(name) => is_package(name).then(|| name.to_owned()),
        None => entry.strip_suffix(".mo").filter(|name| *name != "package").map(str::to_owned),
    };
    let mut names: Vec<String> = entries.iter().filter_map(name).collect();
    if let Some(Ok(order)) = folder.read(&path.join("package.order")) {
        let place = |name: &String| order.lines().position(|line| line.trim() == name);
        names.sort_by_key(|name| place(name).unwrap_or(usize::MAX));
    }
    names
}

fn listed(folder: &dyn Folder, name: &str) -> Option<Listed> {
    let (class, _) = class(folder, name)?;
    let own = inside(&class).count();
    let files = names(folder, &name.split('.').collect::<PathBuf>()).len();
    Some(Listed { classes: own + files, ..entry(name.to_owned(), &class) })
}

fn entry(name: String, class: &Class) -> Listed {
    let description = class.description.as_deref().unwrap_or_default().to_owned();
    let kind = kind(class).to_owned();
    Listed { name, kind, description, classes: inside(class).count() }
}

/// The keyword of a class.
pub fn kind(class: &Class) -> &'static str {
    match class.kind {
        ClassKind::Class => "class",
        ClassKind::Model => "model",
        ClassKind::Block => "block",
        ClassKind::Record | ClassKind::OperatorRecord => "record",
        ClassKind::Connector | ClassKind::ExpandableConnector => "connector",
        ClassKind::Type => "type",
        ClassKind::Package => "package",
        ClassKind::Function { .. } => "function",
        _ => "operator",
    }
}

/// The classes in the text of a class.
fn inside(class: &Class) -> impl Iterator<Item = &Arc<Class>> {
    let elements = match &class.body {
        ClassBody::Long(composition) => composition.elements.as_slice(),
        _ => &[],
    };
    elements.iter().filter_map(|e| match &e.kind {
        ElementKind::Class(class) => Some(class),
        _ => None,
    })
}

/// A class of a folder with its source: of its own file, or in that of a package around it.
fn class(folder: &dyn Folder, full: &str) -> Option<(Arc<Class>, Shown)> {
    let parts: Vec<&str> = full.split('.').collect();
    (1..=parts.len()).rev().find_map(|k| {
        let stem: PathBuf = parts[..k].iter().collect();
        let files = [stem.join("package.mo"), stem.with_extension("mo")];
        let (path, text) = files
            .into_iter()
            .find_map(|p| Some((folder.read(&p)?.ok()?, p)))
            .map(|(t, p)| (p, t))?;
        let (mut sources, mut problems) = (SourceMap::default(), Problems::new());
        let id = sources.add(&path, text.as_str());
        let file = parse(id, &text, &mut problems);
        let mut class = Arc::clone(file.classes.first()?);
        for part in &parts[k..] {
            let next = inside(&class).find(|c| *c.name.name == **part).cloned();
            class = next?;
        }
        let is_file = k == parts.len();
        let line = sources.get(id)?.line_column(class.span.start).0;
        let text = if is_file { text } else { part_of(&text, &class) };
        let line = if is_file { 1 } else { line };
        Some((class, Shown { text, path: folder.display(&path), line }))
    })
}

/// The lines of a class in a file.
fn part_of(text: &str, class: &Class) -> String {
    let (start, end) = (class.span.start as usize, class.span.end as usize);
    let start = text[..start].rfind('\n').map_or(0, |at| at + 1);
    let end = text[end..].find('\n').map_or(text.len(), |at| end + at);
    format!("{}\n", &text[start..end])
}
