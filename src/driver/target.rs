//! What a name at a place in a text refers to: in the class that is modified there, or in the classes around it.

use std::sync::Arc;

use super::dotted_name::DottedName;
use super::role::{Of, Role, role};
use super::subject::{find, find_in};

use crate::base::name::{Name, name};
use crate::base::source::Span;
use crate::classes::ROOT;
use crate::classes::lookup::Found;
use crate::classes::predefined::is_built_in;
use crate::evaluate::Evaluator;
use crate::ir::ast::{
    self, Argument, ArgumentKind, Class, ClassBody, ClassKind, ElementKind, EnumLiteral, Ident,
    Modification,
};
use crate::ir::instance::{ClassId, Entry, EntryKind, Scope};

/// A component of a class, a class, or a literal of an enumeration.
#[derive(Clone)]
pub(super) enum Target {
    Component(Entry),
    Class(ClassId),
    Literal(EnumLiteral),
}

/// The meaning of a word.
pub(super) enum Meaning {
    /// A declaration.
    Declared(Target),
    /// Nothing that a file declares: a name of the language, of a tool, or of a loop.
    Other,
    /// It cannot be found.
    Unknown,
}

/// The meaning of the word that begins at a byte, by the syntax around it. `is_end`: it follows `end`.
pub(super) fn meaning(cx: &mut Evaluator<'_>, file: &ast::File, at: u32, is_end: bool) -> Meaning {
    let chain = enclosing(file, at).map(|(chain, _)| chain).unwrap_or_default();
    let innermost = class_named(cx, file, &chain);
    let declared = |found: Option<Target>| found.map_or(Meaning::Unknown, Meaning::Declared);
    if is_end {
        return declared(innermost.map(Target::Class));
    }
    match role(file, at) {
        Some(Role::Class) => declared(innermost.map(Target::Class)),
        Some(Role::Component(own)) => declared(innermost.and_then(|class| member(cx, class, &own))),
        Some(Role::Literal(own)) => declared(innermost.and_then(|class| literal(cx, class, &own))),
        Some(Role::Local | Role::Foreign) => Meaning::Other,
        Some(Role::Reference { parts, global, loose }) => {
            match reference(cx, file, &chain, &parts, global) {
                Meaning::Unknown if loose => Meaning::Other,
                found => found,
            }
        }
        Some(Role::Element { of, parts }) => element(cx, file, &chain, &of, &parts),
        None => Meaning::Unknown,
    }
}

/// The class around a place in which names are looked up: the names of a short class are those around it.
fn scope(chain: &[Arc<Class>]) -> &[Arc<Class>] {
    match chain.last().map(|class| &class.body) {
        Some(ClassBody::Long(_)) | None => chain,
        Some(_) => &chain[..chain.len() - 1],
    }
}

fn reference(
    cx: &mut Evaluator<'_>,
    file: &ast::File,
    chain: &[Arc<Class>],
    parts: &[Name],
    global: bool,
) -> Meaning {
    let Some((first, rest)) = parts.split_first() else { return Meaning::Unknown };
    let around = scope(chain);
    let class = match (global, around.is_empty()) {
        (true, _) => Some(ROOT.class),
        (false, true) => {
            file.package().map_or(Some(ROOT.class), |package| find(cx, &package.to_string()))
        }
        (false, false) => class_named(cx, file, around),
    };
    let Some(class) = class else { return Meaning::Unknown };
    let mut found = member(cx, class, first);
    if found.is_none() && !global {
        let scope = Scope { instance: cx.classes[class].holder, class };
        found = match cx.find_first(*first, scope) {
            Some(Found::Class(class)) => Some(Target::Class(class)),
            Some(Found::Component(package, wanted)) => member(cx, package, &wanted),
            None => None,
        };
    }
    let Some(mut target) = found else {
        return match is_built_in(first) || cx.predefined.contains_key(first) {
            true => Meaning::Other,
            false => Meaning::Unknown,
        };
    };
    for part in rest {
        if is_of_language(cx, &target) {
            return Meaning::Other;
        }
        let next = class_of(cx, &target).and_then(|class| member(cx, class, part));
        match next {
            Some(next) => target = next,
            // An error of the file, whatever else is declared.
            None if is_whole_package(cx, &target) => return Meaning::Other,
            None => return Meaning::Unknown,
        }
    }
    match is_of_language(cx, &target) {
        true => Meaning::Other,
        false => Meaning::Declared(target),
    }
}

/// Whether a target is a package that has all of its classes: no other takes its place.
fn is_whole_package(cx: &mut Evaluator<'_>, target: &Target) -> bool {
    let Target::Class(class) = *target else { return false };
    let Some(text) = cx.definition(class).cloned() else { return false };
    if text.kind != ClassKind::Package || text.partial {
        return false;
    }
    let Some(around) = cx.classes[class].enclosing.filter(|around| *around != ROOT.class) else {
        return true;
    };
    let table = cx.table(around);
    let entry = table.index.get(&text.name.name).map(|at| &table.entries[*at]);
    entry.is_none_or(|entry| entry.element.replaceable.is_none())
}

/// Whether a class is one that the language defines.
fn is_of_language(cx: &Evaluator<'_>, target: &Target) -> bool {
    matches!(target, Target::Class(class) if cx.definition(*class).is_none())
}

/// An element of a class that is modified, or an argument of a function.
fn element(
    cx: &mut Evaluator<'_>,
    file: &ast::File,
    chain: &[Arc<Class>],
    of: &Of,
    parts: &[Name],
) -> Meaning {
    let class = match of.parts.is_empty() {
        true => class_named(cx, file, chain),
        false => match reference(cx, file, chain, &of.parts, of.global) {
            Meaning::Declared(target) => class_of(cx, &target),
            // `Real x(start = 1)`, `sum(x = 1)`.
            Meaning::Other => return Meaning::Other,
            Meaning::Unknown => None,
        },
    };
    let Some(mut class) = class else { return Meaning::Unknown };
    for part in &of.element {
        let Some(target) = member(cx, class, part) else {
            // Attributes have no elements.
            return Meaning::Unknown;
        };
        let Some(next) = class_of(cx, &target) else { return Meaning::Unknown };
        class = next;
    }
    // A constructor that is a function has arguments of its own.
    if cx.definition(class).is_some_and(|text| text.kind == ClassKind::OperatorRecord) {
        return Meaning::Unknown;
    }
    let text: Vec<String> = parts.iter().map(|part| part.to_string()).collect();
    match path(cx, class, &text, false) {
        Some(target) => Meaning::Declared(target),
        None if cx.definition(class).is_none() || cx.table(class).scalar.is_some() => {
            Meaning::Other
        }
        None => Meaning::Unknown,
    }
}

/// A literal of an enumeration, or of the one that a short class names.
fn literal(cx: &mut Evaluator<'_>, class: ClassId, wanted: &str) -> Option<Target> {
    let text = Arc::clone(cx.definition(class)?);
    match &text.body {
        ClassBody::Enumeration(literals) => {
            let found = literals.iter().flatten().find(|literal| &*literal.name.name == wanted)?;
            Some(Target::Literal(found.clone()))
        }
        ClassBody::Short(_) => {
            let bases = cx.table(class).bases.clone();
            bases.into_iter().find_map(|base| literal(cx, base, wanted))
        }
        _ => None,
    }
}

/// The classes around a place, from the outermost, and the full name of the innermost.
pub(super) fn enclosing(file: &ast::File, offset: u32) -> Option<(Vec<Arc<Class>>, String)> {
    let holds = |class: &Class| class.span.start <= offset && offset <= class.span.end;
    let mut chain = vec![Arc::clone(file.classes.iter().find(|class| holds(class))?)];
    while let Some(ClassBody::Long(composition)) = chain.last().map(|class| &class.body) {
        let inner = composition.elements.iter().find_map(|e| match &e.kind {
            ElementKind::Class(class) if holds(class) => Some(Arc::clone(class)),
            _ => None,
        });
        match inner {
            Some(class) => chain.push(class),
            None => break,
        }
    }
    let names: Vec<String> = chain.iter().map(|class| class.name.name.to_string()).collect();
    let full = names.join(".");
    Some((chain, full))
}

pub(super) fn class_named(
    cx: &mut Evaluator<'_>,
    file: &ast::File,
    chain: &[Arc<Class>],
) -> Option<ClassId> {
    let names: Vec<String> = chain.iter().map(|class| class.name.name.to_string()).collect();
    find_in(cx, file, &names.join("."))
}

/// What a name refers to: in the class that is modified there, or in the classes around it.
pub(super) fn resolve(
    cx: &mut Evaluator<'_>,
    file: &ast::File,
    word: &DottedName,
    offset: u32,
) -> Option<Target> {
    let Some((chain, _)) = enclosing(file, offset) else {
        return path(cx, ROOT.class, &word.parts, true);
    };
    let innermost = class_named(cx, file, &chain)?;
    let own = chain.last()?;
    if own.name.span.start <= offset && offset <= own.name.span.end {
        return Some(Target::Class(innermost));
    }
    if let Some(modified) = modified_name(cx, innermost, own, offset) {
        return path(cx, modified, &word.parts, false);
    }
    for k in (1..=chain.len()).rev() {
        let Some(class) = class_named(cx, file, &chain[..k]) else { continue };
        if let Some(found) = path(cx, class, &word.parts, k == chain.len()) {
            return Some(found);
        }
    }
    None
}

/// A dotted name among the elements of a class and, `lexically`, among all classes that it can see.
pub(super) fn path(
    cx: &mut Evaluator<'_>,
    class: ClassId,
    parts: &[String],
    lexically: bool,
) -> Option<Target> {
    let (first, rest) = parts.split_first()?;
    let mut target = member(cx, class, first).or_else(|| {
        let scope = Scope { instance: cx.classes[class].holder, class };
        let ident = Ident { name: name(first), span: Span::NONE };
        let wanted = ast::Path { global: false, parts: vec![ident], span: Span::NONE };
        lexically.then(|| cx.find_class(&wanted, scope)).flatten().map(Target::Class)
    })?;
    for part in rest {
        let class = class_of(cx, &target)?;
        target = member(cx, class, part)?;
    }
    Some(target)
}

pub(super) fn member(cx: &mut Evaluator<'_>, class: ClassId, wanted: &str) -> Option<Target> {
    if class != ROOT.class && cx.definition(class).is_some() {
        let table = cx.table(class);
        if let Some(entry) = table.index.get(&name(wanted)).map(|k| table.entries[*k].clone())
            && matches!(entry.kind, EntryKind::Component(_))
        {
            return Some(Target::Component(entry));
        }
    }
    let holder = cx.classes[class].holder;
    let found = cx.member_class(class, name(wanted), holder).map(Target::Class);
    found.or_else(|| literal(cx, class, wanted))
}

/// The class of a component, or the class itself.
pub(super) fn class_of(cx: &mut Evaluator<'_>, target: &Target) -> Option<ClassId> {
    match target {
        Target::Class(class) => Some(*class),
        Target::Literal(_) => None,
        Target::Component(entry) => {
            let EntryKind::Component(declaration) = &entry.kind else { return None };
            // `extends Base(redeclare T a)`: the outermost redeclaration counts.
            let redeclared = entry.layers.iter().find_map(|(modification, class)| {
                Some((redeclared_type(modification, &entry.name)?, *class))
            });
            let (path, class) = match redeclared {
                Some((path, class)) => (path, class),
                None => (declaration.clause().type_name.clone(), entry.class),
            };
            let scope = Scope { instance: cx.classes[class].holder, class };
            cx.find_class(&path, scope)
        }
    }
}

/// The type that a modification gives to a component.
fn redeclared_type(modification: &Modification, component: &Ident) -> Option<ast::Path> {
    modification.args.iter().find_map(|argument| {
        let ArgumentKind::Redeclare(element) = &argument.kind else { return None };
        let ElementKind::Components(clause) = &element.kind else { return None };
        let is_own = clause.components.iter().any(|c| c.name.name == component.name);
        is_own.then(|| clause.type_name.clone())
    })
}

/// The class whose elements the arguments at a place modify, if the place is in the name of an argument.
pub(super) fn modified_name(
    cx: &mut Evaluator<'_>,
    class: ClassId,
    text: &Class,
    offset: u32,
) -> Option<ClassId> {
    let (modification, class) = modification(cx, class, text, offset)?;
    descend(cx, modification, class, offset)
}

/// The modification of a component or base class around a place, and the class that it modifies.
fn modification<'t>(
    cx: &mut Evaluator<'_>,
    class: ClassId,
    text: &'t Class,
    offset: u32,
) -> Option<(&'t Modification, ClassId)> {
    let holds = |span: Span| span.start <= offset && offset <= span.end;
    let scope = Scope { instance: cx.classes[class].holder, class };
    let ClassBody::Long(composition) = &text.body else { return None };
    for element in composition.elements.iter().filter(|e| holds(e.span)) {
        let (of, found): (&ast::Path, _) = match &element.kind {
            ElementKind::Components(clause) => {
                let found = clause
                    .components
                    .iter()
                    .find_map(|c| c.modification.as_deref().filter(|m| holds(m.span)));
                (&clause.type_name, found)
            }
            ElementKind::Extends(extends) => {
                (&extends.base, extends.modification.as_deref().filter(|m| holds(m.span)))
            }
            _ => continue,
        };
        if let Some(found) = found {
            return Some((found, cx.find_class(of, scope)?));
        }
    }
    None
}

fn descend(
    cx: &mut Evaluator<'_>,
    modification: &Modification,
    class: ClassId,
    offset: u32,
) -> Option<ClassId> {
    let holds = |span: Span| span.start <= offset && offset <= span.end;
    if modification.binding.as_ref().is_some_and(|b| holds(b.span)) {
        return None;
    }
    let argument: &Argument = modification.args.iter().find(|arg| holds(arg.span))?;
    let ArgumentKind::Element { path: own, modification: inner, .. } = &argument.kind else {
        return None;
    };
    if holds(own.span) {
        return Some(class);
    }
    let inner = inner.as_deref().filter(|m| holds(m.span))?;
    let parts: Vec<String> = own.parts.iter().map(|part| part.name.to_string()).collect();
    let target = path(cx, class, &parts, false)?;
    let class = class_of(cx, &target)?;
    descend(cx, inner, class, offset)
}

/// What a dotted name refers to at a place.
pub(super) fn named(
    cx: &mut Evaluator<'_>,
    file: &ast::File,
    at: u32,
    parts: &[String],
) -> Option<Target> {
    let chain = enclosing(file, at).map(|(chain, _)| chain).unwrap_or_default();
    let parts: Vec<Name> = parts.iter().map(|part| name(part)).collect();
    match reference(cx, file, &chain, &parts, false) {
        Meaning::Declared(target) => Some(target),
        Meaning::Other | Meaning::Unknown => None,
    }
}
