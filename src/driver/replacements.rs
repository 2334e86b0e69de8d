//! What a model lets its user replace: every `replaceable` class and component, with the classes that may stand in its
//! place (Modelica 3.6, section 7.3).

use crate::base::name::Name;
use crate::classes::ClassGraph;
use crate::evaluate::Evaluator;
use crate::ir::ast::{ClassBody, ClassKind, ElementKind, Path};
use crate::ir::instance::{ClassId, Entry, EntryKind, Scope};
use crate::resolve::library::Library;

use super::compile::{Request, Session};
use super::subject::{find, model};

/// Depth of components within which replaceable elements are looked for.
const MAX_DEPTH: usize = 2;
/// Length of a chain of base classes that is followed.
const MAX_BASES: usize = 30;

/// Another class for a replaceable element.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Replacement {
    /// Full name of the element.
    pub element: String,
    /// The keyword of a replaceable class, such as `model`; `None` for a component.
    pub keyword: Option<&'static str>,
    /// Full name of the class.
    pub class: String,
}

impl Session {
    /// The replacements that the elements of a model allow, by classes that extend their constraining class and stand
    /// beside it, beside the present class, or in the file of the model. None if the model cannot be found.
    pub fn replacements(&mut self, request: &Request) -> Vec<Replacement> {
        let mut library = Library::new(super::files::folders(request));
        let Ok(file) = self.read(request, &mut library) else { return Vec::new() };
        let own = file.iter().flat_map(|f| f.classes.iter().map(|c| c.name.name.to_string()));
        let within = file.as_ref().and_then(|f| Some(f.package()?.to_string()));
        let own: Vec<String> = own.map(|name| joined(within.as_deref(), &name)).collect();
        let mut cx =
            Evaluator::new(ClassGraph::new(&mut self.sources, &mut self.problems, &mut library));
        let Ok(class) = model(&mut cx, request, file.as_deref()) else { return Vec::new() };
        let mut found = Vec::new();
        visit(&mut cx, class, &mut Vec::new(), &own, &mut found);
        found
    }
}

/// Adds the replacements in a class that is at a path of components.
fn visit(
    cx: &mut Evaluator<'_>,
    class: ClassId,
    at: &mut Vec<Name>,
    own: &[String],
    found: &mut Vec<Replacement>,
) {
    let table = cx.table(class);
    for entry in table.entries.iter().filter(|e| !e.protected) {
        let scope = cx.declaration_scope(entry);
        if entry.element.replaceable.is_some() && !entry.element.is_final {
            replacements(cx, entry, scope, at, own, found);
        }
        if let EntryKind::Component(declaration) = &entry.kind
            && at.len() < MAX_DEPTH
            && let Some(inner) = cx.find_class(&declaration.clause().type_name, scope)
            && matches!(cx.kind(inner), ClassKind::Model | ClassKind::Block | ClassKind::Class)
        {
            at.push(entry.name.name);
            visit(cx, inner, at, own, found);
            at.pop();
        }
    }
}

fn replacements(
    cx: &mut Evaluator<'_>,
    entry: &Entry,
    scope: Scope,
    at: &[Name],
    own: &[String],
    found: &mut Vec<Replacement>,
) {
    let (keyword, present) = match &entry.kind {
        EntryKind::Component(declaration) => (None, Some(declaration.clause().type_name.clone())),
        EntryKind::Class(class) => {
            let Some(keyword) = keyword(class.kind) else { return };
            match &class.body {
                ClassBody::Short(short) => (Some(keyword), Some(short.base.clone())),
                _ => (Some(keyword), None),
            }
        }
    };
    let present = present.and_then(|path| cx.find_class(&path, scope));
    let constraint = entry.element.replaceable.as_ref().and_then(|r| r.constraint.clone());
    let constraint = match constraint {
        Some(path) => cx.find_class(&path, scope),
        None => present,
    };
    let Some(constraint) = constraint else { return };
    let path: Vec<&str> = at.iter().chain([&entry.name.name]).map(Name::as_str).collect();
    for name in candidates(cx, [Some(constraint), present], own) {
        let Some(class) = find(cx, &name) else { continue };
        let is_present = present.is_some_and(|p| cx.is_same_definition(class, p));
        let is_whole = cx.partial_definition(class).is_none();
        let is_model =
            matches!(cx.kind(class), ClassKind::Model | ClassKind::Block | ClassKind::Class);
        if is_whole && is_model && !is_present && descends(cx, class, constraint, 0) {
            found.push(Replacement { element: path.join("."), keyword, class: name });
        }
    }
}

/// Full names of the classes beside others, and of those of the model's file.
fn candidates(cx: &mut Evaluator<'_>, beside: [Option<ClassId>; 2], own: &[String]) -> Vec<String> {
    let mut names = own.to_vec();
    for class in beside.into_iter().flatten() {
        let full = cx.classes[class].full_name.to_string();
        if let Some((package, _)) = full.rsplit_once('.') {
            let children = cx.library.child_names(package);
            names.extend(children.into_iter().map(|name| format!("{package}.{name}")));
        }
    }
    names.sort();
    names.dedup();
    names
}

/// True for a class that extends another, directly or not.
fn descends(cx: &mut Evaluator<'_>, class: ClassId, from: ClassId, depth: usize) -> bool {
    if cx.is_same_definition(class, from) {
        return true;
    }
    let Some(text) = cx.definition(class).cloned().filter(|_| depth < MAX_BASES) else {
        return false;
    };
    let bases: Vec<&Path> = match &text.body {
        ClassBody::Short(short) => vec![&short.base],
        ClassBody::Long(composition) => {
            let extends = composition.elements.iter().filter_map(|e| match &e.kind {
                ElementKind::Extends(extends) => Some(&extends.base),
                _ => None,
            });
            extends.collect()
        }
        _ => Vec::new(),
    };
    let scope = match &text.body {
        ClassBody::Short(_) => cx.outside(class),
        _ => Scope { instance: cx.classes[class].holder, class },
    };
    bases.into_iter().any(|base| {
        let base = cx.find_class(base, scope).filter(|base| *base != class);
        base.is_some_and(|base| descends(cx, base, from, depth + 1))
    })
}

/// The keyword with which a class of this kind is redeclared, if it can be one of a model's laws.
fn keyword(kind: ClassKind) -> Option<&'static str> {
    match kind {
        ClassKind::Model => Some("model"),
        ClassKind::Block => Some("block"),
        ClassKind::Class => Some("class"),
        _ => None,
    }
}

fn joined(package: Option<&str>, name: &str) -> String {
    package.map_or(name.to_owned(), |package| format!("{package}.{name}"))
}
