//! Statements and modifications of a class definition, wherever the class is used: `break` outside
//! loops, nested `when`, inputs that are assigned, elements that are modified twice (sections
//! 7.2.3, 11.2, 12.2 and 13.2.1 of the specification).

use std::sync::Arc;

use super::cause::element::{ElementCause, WhenPlace};
use super::cause::specialized_class::SpecializedClassCause;
use crate::base::diag::{Diagnostic, Problems};
use crate::base::index::FastMap;
use crate::base::name::Name;
use crate::base::source::Span;
use crate::classes::ClassGraph;
use crate::ir::ast::{
    ArgumentKind, Causality, Class, ClassBody, ClassKind, ComponentRef, Composition, ElementKind,
    Ident, ImportForm, Modification, Statement, StatementKind,
};
use crate::ir::instance::{ClassId, EntryKind, Scope};

/// The context of a statement.
#[derive(Clone, Copy)]
struct Around<'a> {
    function: bool,
    initial: bool,
    in_loop: bool,
    /// The enclosing statement.
    inside: Option<WhenPlace>,
    /// Inputs of the function.
    inputs: &'a FastMap<Name, Span>,
    /// The iterators of the loops around it.
    iterators: &'a [Ident],
}

/// Checks the body of a class whose elements are known, once per definition.
pub(crate) fn check_body(cx: &mut ClassGraph<'_>, class: ClassId, text: &Arc<Class>) {
    match &text.body {
        ClassBody::Short(short) => {
            check_duplicates(cx.problems, short.modification.as_ref());
        }
        ClassBody::Long(composition) => {
            check_elements(cx.problems, composition);
            cx.check_imports(composition);
            let function = matches!(text.kind, ClassKind::Function { .. });
            if composition.algorithms.is_empty() {
                return;
            }
            let inputs = if function { inputs_of(cx, class) } else { FastMap::default() };
            for section in &composition.algorithms {
                let around = Around {
                    function,
                    initial: section.initial,
                    in_loop: false,
                    inside: None,
                    inputs: &inputs,
                    iterators: &[],
                };
                check_statements(cx.problems, &section.statements, around);
            }
        }
        _ => {}
    }
}

fn inputs_of(cx: &mut ClassGraph<'_>, class: ClassId) -> FastMap<Name, Span> {
    let table = cx.table(class);
    let mut inputs = FastMap::default();
    for entry in &table.entries {
        let EntryKind::Component(declaration) = &entry.kind else { continue };
        if cx.causality(entry, declaration) == Some(Causality::Input) {
            inputs.insert(entry.name.name, entry.name.span);
        }
    }
    inputs
}

fn check_elements(problems: &mut Problems, composition: &Composition) {
    let mut imported: FastMap<Name, Span> = FastMap::default();
    for element in &composition.elements {
        match &element.kind {
            ElementKind::Components(clause) => {
                for component in &clause.components {
                    check_duplicates(problems, component.modification.as_ref());
                }
            }
            ElementKind::Extends(extends) => {
                check_duplicates(problems, extends.modification.as_ref());
            }
            ElementKind::Import(import) => {
                let names = match &import.form {
                    ImportForm::Qualified => {
                        import.path.parts.last().copied().into_iter().collect()
                    }
                    ImportForm::Renamed(alias) => vec![*alias],
                    ImportForm::List(names) => names.clone(),
                    ImportForm::All => Vec::new(),
                };
                for name in names {
                    if let Some(before) = imported.insert(name.name, name.span) {
                        let cause = ElementCause::ImportedTwice { name: name.name };
                        problems.push(
                            Diagnostic::new(cause, name.span)
                                .label("second import of this name")
                                .also(before, "first import"),
                        );
                    }
                }
            }
            ElementKind::Class(_) => {}
        }
    }
}

/// One modification may not say two things of the same element.
fn check_duplicates(problems: &mut Problems, modification: Option<&Arc<Modification>>) {
    let Some(modification) = modification else { return };
    let mut said = Vec::new();
    values(modification, "", &mut said);
    let mut first: FastMap<(String, bool), Span> = FastMap::default();
    for (names, redeclared, span) in said {
        let before = *first.entry((names.clone(), redeclared)).or_insert(span);
        if before != span {
            problems.push(
                Diagnostic::new(ElementCause::ModifiedTwice { names, redeclared }, span)
                    .label("second value")
                    .also(before, "first value"),
            );
        }
    }
}

fn check_statements(problems: &mut Problems, list: &[Statement], around: Around<'_>) {
    for s in list {
        match &s.kind {
            StatementKind::Assign(target, _) => check_target(problems, target, around),
            StatementKind::AssignTuple(targets, _) => {
                for target in targets.iter().flatten() {
                    check_target(problems, target, around);
                }
            }
            StatementKind::If { branches, otherwise } => {
                let inner = Around { inside: Some(WhenPlace::If), ..around };
                for (_, body) in branches {
                    check_statements(problems, body, inner);
                }
                check_statements(problems, otherwise, inner);
            }
            StatementKind::For { iterators, body } => {
                let own = iterators.iter().map(|iterator| iterator.name);
                let iterators: Vec<Ident> = around.iterators.iter().copied().chain(own).collect();
                let inside = Some(WhenPlace::For);
                let inner = Around { inside, in_loop: true, iterators: &iterators, ..around };
                check_statements(problems, body, inner);
            }
            StatementKind::While { body, .. } => {
                let inner = Around { inside: Some(WhenPlace::While), in_loop: true, ..around };
                check_statements(problems, body, inner);
            }
            StatementKind::When { branches } => {
                check_when(problems, s.span, around);
                let inner = Around { inside: Some(WhenPlace::When), in_loop: false, ..around };
                for (_, body) in branches {
                    check_statements(problems, body, inner);
                }
            }
            StatementKind::Break if !around.in_loop => {
                problems.push(Diagnostic::new(ElementCause::BreakOutsideLoop, s.span));
            }
            StatementKind::Return if !around.function => {
                problems.push(Diagnostic::new(ElementCause::ReturnOutsideFunction, s.span));
            }
            StatementKind::Break
            | StatementKind::Return
            | StatementKind::Call(_)
            | StatementKind::Broken => {}
        }
    }
}

fn check_when(problems: &mut Problems, span: Span, around: Around<'_>) {
    let inside = match around {
        Around { function: true, .. } => WhenPlace::Function,
        Around { initial: true, .. } => WhenPlace::Initial,
        Around { inside: Some(place), .. } => place,
        Around { inside: None, .. } => return,
    };
    problems.push(Diagnostic::new(ElementCause::MisplacedWhen { inside }, span));
}

fn check_target(problems: &mut Problems, target: &ComponentRef, around: Around<'_>) {
    let first = target.parts[0].name;
    if let Some(iterator) = around.iterators.iter().rfind(|i| i.name == first.name) {
        problems.push(
            Diagnostic::new(ElementCause::IteratorAssigned { name: first.name }, first.span)
                .also(iterator.span, "counts this loop"),
        );
        return;
    }
    let Some(declared) = around.inputs.get(&first.name) else { return };
    problems.push(
        Diagnostic::new(ElementCause::InputAssigned { name: first.name }, first.span)
            .also(*declared, "declared `input`")
            .note("inputs of functions keep their values"),
    );
}

/// Checks the components of a function where it is called.
pub(crate) fn check_function(cx: &mut ClassGraph<'_>, class: ClassId) {
    if !cx.checked_functions.insert(class) {
        return;
    }
    let table = cx.table(class);
    for entry in &table.entries {
        let EntryKind::Component(declaration) = &entry.kind else { continue };
        let clause = declaration.clause();
        let free = entry.protected || clause.prefix.variability.is_some();
        if !free && cx.causality(entry, declaration).is_none() {
            let name = cx.classes[class].full_name;
            let name = crate::base::name::name(name.rsplit('.').next().unwrap_or_default());
            super::specialized_class::report_formal(cx.problems, name, entry.name);
        }
        if clause.type_name.parts.len() == 1
            && cx.predefined.contains_key(&clause.type_name.parts[0].name)
        {
            continue;
        }
        let scope = Scope { instance: cx.classes[entry.class].holder, class: entry.class };
        let Some(of) = cx.find_class(&clause.type_name, scope) else { continue };
        let kind = cx.kind(of);
        if matches!(kind, ClassKind::Model | ClassKind::Block) {
            let cause = SpecializedClassCause::ModelInFunction { name: entry.name.name, kind };
            cx.problems.push(
                Diagnostic::new(cause, entry.name.span)
                    .note("components of functions are of types, records or functions"),
            );
        }
    }
}

/// The elements that a modification binds or redeclares, by full name, with their places.
fn values(modification: &Modification, around: &str, out: &mut Vec<(String, bool, Span)>) {
    for arg in &modification.args {
        match &arg.kind {
            ArgumentKind::Element { path, modification: Some(inner), .. } => {
                let names = format!("{around}{path}");
                values(inner, &format!("{names}."), out);
                if inner.binding.is_some() {
                    out.push((names, false, arg.span));
                }
            }
            ArgumentKind::Redeclare(element) => {
                for (name, span) in element.names() {
                    out.push((format!("{around}{name}"), true, span));
                }
            }
            ArgumentKind::Element { .. } | ArgumentKind::Removal(_) => {}
        }
    }
}
