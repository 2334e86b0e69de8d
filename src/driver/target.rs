//! What a name at a place in a text refers to: in the class that is modified there, or in the classes around it.

use std::sync::Arc;

use super::dotted_name::DottedName;
use super::subject::find_in;

use crate::base::name::name;
use crate::base::source::Span;
use crate::classes::ROOT;
use crate::evaluate::Evaluator;
use crate::ir::ast::{
    self, Argument, ArgumentKind, Class, ClassBody, ElementKind, Ident, Modification,
};
use crate::ir::instance::{ClassId, Entry, EntryKind, Scope};

/// A component of a class, or a class.
#[derive(Clone)]
pub(super) enum Target {
    Component(Entry),
    Class(ClassId),
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
fn path(
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

fn member(cx: &mut Evaluator<'_>, class: ClassId, wanted: &str) -> Option<Target> {
    if class != ROOT.class && cx.definition(class).is_some() {
        let table = cx.table(class);
        if let Some(entry) = table.index.get(&name(wanted)).map(|k| table.entries[*k].clone())
            && matches!(entry.kind, EntryKind::Component(_))
        {
            return Some(Target::Component(entry));
        }
    }
    let holder = cx.classes[class].holder;
    cx.member_class(class, name(wanted), holder).map(Target::Class)
}

/// The class of a component, or the class itself.
pub(super) fn class_of(cx: &mut Evaluator<'_>, target: &Target) -> Option<ClassId> {
    match target {
        Target::Class(class) => Some(*class),
        Target::Component(entry) => {
            let EntryKind::Component(declaration) = &entry.kind else { return None };
            let scope = Scope { instance: cx.classes[entry.class].holder, class: entry.class };
            cx.find_class(&declaration.clause().type_name, scope)
        }
    }
}

/// The class whose elements the arguments at a place modify.
pub(super) fn modified(
    cx: &mut Evaluator<'_>,
    class: ClassId,
    text: &Class,
    offset: u32,
) -> Option<ClassId> {
    let (modification, class) = modification(cx, class, text, offset)?;
    descend(cx, modification, class, offset, false)
}

/// As [`modified`], if the place is in the name of an argument, not in its value.
pub(super) fn modified_name(
    cx: &mut Evaluator<'_>,
    class: ClassId,
    text: &Class,
    offset: u32,
) -> Option<ClassId> {
    let (modification, class) = modification(cx, class, text, offset)?;
    descend(cx, modification, class, offset, true)
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
    in_name: bool,
) -> Option<ClassId> {
    let holds = |span: Span| span.start <= offset && offset <= span.end;
    if modification.binding.as_ref().is_some_and(|b| holds(b.span)) {
        return None;
    }
    let Some(Argument {
        kind: ArgumentKind::Element { path: own, modification: inner, .. }, ..
    }) = modification.args.iter().find(|arg| holds(arg.span))
    else {
        return (!in_name).then_some(class);
    };
    if holds(own.span) {
        return Some(class);
    }
    let inner = inner.as_deref().filter(|m| holds(m.span))?;
    let parts: Vec<String> = own.parts.iter().map(|part| part.name.to_string()).collect();
    let target = path(cx, class, &parts, false)?;
    let class = class_of(cx, &target)?;
    descend(cx, inner, class, offset, in_name)
}
