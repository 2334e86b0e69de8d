//! Restrictions of the specialised classes (sections 4.6, 4.8 and 7.1.3 of the specification).

use super::cause::specialized_class::{Forbidden, SpecializedClassCause};
use crate::base::diag::{Diagnostic, Problems};
use crate::base::name::Name;
use crate::base::source::Span;
use crate::classes::ClassGraph;
use crate::ir::ast::{
    self, Causality, Class, ClassBody, ClassKind, Composition, ConnectionPrefix, ElementKind,
    Variability,
};
use crate::ir::instance::{ClassId, ClassTable, Scope};

/// Names of predefined types: nothing else can have them.
const PREDEFINED: [&str; 5] = ["Real", "Integer", "Boolean", "String", "ExternalObject"];
/// The name of a predefined enumeration, which no component can have.
const STATE_SELECT: &str = "StateSelect";
/// Attributes that would be hidden by literals of an enumeration.
const ATTRIBUTES: [&str; 5] = ["quantity", "min", "max", "start", "fixed"];
const DIFFER: &str = "specialized classes differ in the elements that they may have";

/// Checks the definition of a class.
pub(crate) fn check_definition(problems: &mut Problems, text: &Class) {
    check_name(problems, text.name.name, text.name.span, false);
    match &text.body {
        ClassBody::Enumeration(Some(literals)) => {
            for (k, literal) in literals.iter().enumerate() {
                if let Some(before) =
                    literals[..k].iter().find(|l| l.name.name == literal.name.name)
                {
                    let cause = SpecializedClassCause::LiteralTwice { name: literal.name.name };
                    problems.push(
                        Diagnostic::new(cause, literal.name.span).also(before.name.span, "first"),
                    );
                }
                if ATTRIBUTES.contains(&literal.name.name.as_str()) {
                    let cause = SpecializedClassCause::LiteralAttribute { name: literal.name.name };
                    problems.push(Diagnostic::new(cause, literal.name.span));
                }
            }
        }
        ClassBody::Long(composition) => check_parts(problems, text, composition),
        _ => {}
    }
}

fn check_name(problems: &mut Problems, text: Name, span: Span, component: bool) {
    if PREDEFINED.contains(&text.as_str()) || component && text == STATE_SELECT {
        problems.push(Diagnostic::new(SpecializedClassCause::PredefinedName { name: text }, span));
    }
}

fn check_parts(problems: &mut Problems, text: &Class, composition: &Composition) {
    let kind = text.kind;
    let connector = matches!(kind, ClassKind::Connector | ClassKind::ExpandableConnector);
    let record = matches!(kind, ClassKind::Record | ClassKind::OperatorRecord);
    let function = matches!(kind, ClassKind::Function { .. });
    let name = text.name.name;
    let equations = composition.equations.iter().any(|s| !s.equations.is_empty());
    let algorithms = composition.algorithms.iter().any(|s| !s.statements.is_empty());
    if (connector || record) && (equations || algorithms) || function && equations {
        let section = if equations { "equations" } else { "algorithms" };
        let cause = SpecializedClassCause::ForbiddenSection { kind, class: name, section };
        problems.push(Diagnostic::new(cause, text.name.span).note(DIFFER));
    }
    if function {
        check_sections(problems, text, composition);
    }
    for element in &composition.elements {
        let component = matches!(element.kind, ElementKind::Components(_));
        for (declared, at) in element.names() {
            check_name(problems, declared, at, component);
        }
        if kind == ClassKind::Operator {
            check_operator(problems, name, element);
        }
        let ElementKind::Components(clause) = &element.kind else { continue };
        let Some(first) = clause.components.first().map(|c| c.name) else { continue };
        let mut forbid = |is| {
            let element = first.name;
            let cause = SpecializedClassCause::ForbiddenElement { element, kind, class: name, is };
            problems.push(Diagnostic::new(cause, first.span).note(DIFFER));
        };
        if (connector || record) && (element.inner || element.outer) {
            forbid(if element.inner { Forbidden::Inner } else { Forbidden::Outer });
        }
        if (connector || record) && element.protected {
            forbid(Forbidden::Protected);
        }
        if record && (clause.prefix.connection.is_some() || clause.prefix.causality.is_some()) {
            forbid(match (clause.prefix.connection, clause.prefix.causality) {
                (Some(ConnectionPrefix::Flow), _) => Forbidden::Flow,
                (Some(ConnectionPrefix::Stream), _) => Forbidden::Stream,
                (None, Some(Causality::Input)) => Forbidden::Input,
                _ => Forbidden::Output,
            });
        }
        if !(connector || record) && clause.prefix.connection == Some(ConnectionPrefix::Stream) {
            forbid(Forbidden::StreamOutsideConnector);
        }
        if function && element.protected && clause.prefix.causality.is_some() {
            forbid(Forbidden::ProtectedFormal);
        }
        if kind == ClassKind::Package && clause.prefix.variability != Some(Variability::Constant) {
            forbid(Forbidden::NotConstant);
        }
    }
}

/// A function has one algorithm, and not to find its start (section 12.2).
fn check_sections(problems: &mut Problems, text: &Class, composition: &Composition) {
    let name = text.name.name;
    for (k, section) in composition.algorithms.iter().enumerate() {
        if !section.initial && k == 0 {
            continue;
        }
        let cause =
            SpecializedClassCause::FunctionAlgorithm { function: name, initial: section.initial };
        problems.push(Diagnostic::new(cause, section.span).also(text.name.span, "declared here"));
    }
}

/// An operator holds functions (section 4.6).
fn check_operator(problems: &mut Problems, operator: Name, element: &ast::Element) {
    let wrong = match &element.kind {
        ElementKind::Class(c) => !matches!(c.kind, ClassKind::Function { .. }),
        ElementKind::Components(_) => true,
        ElementKind::Import(_) | ElementKind::Extends(_) => false,
    };
    for (declared, at) in element.names().into_iter().filter(|_| wrong) {
        let cause = SpecializedClassCause::OtherInOperator { element: declared, operator };
        problems.push(Diagnostic::new(cause, at));
    }
    if operator == "'constructor'"
        && let ElementKind::Class(function) = &element.kind
    {
        check_constructor(problems, function);
    }
}

/// A constructor of an operator record gives that record, and nothing else (section 14.3).
fn check_constructor(problems: &mut Problems, function: &Class) {
    let ClassBody::Long(composition) = &function.body else { return };
    let outputs = composition.elements.iter().filter_map(|e| match &e.kind {
        ElementKind::Components(c) if c.prefix.causality == Some(Causality::Output) => {
            Some(c.components.iter().map(|c| c.name))
        }
        _ => None,
    });
    if let Some(second) = outputs.flatten().nth(1) {
        let cause = SpecializedClassCause::SecondOutput {
            constructor: function.name.name,
            output: second.name,
        };
        problems.push(Diagnostic::new(cause, second.span));
    }
}

/// A class may extend classes of these kinds only (section 7.1.3).
pub(crate) fn check_base(cx: &mut ClassGraph<'_>, text: &Class, base: ClassId, span: Span) {
    let of_base = match cx.definition(base).map(|t| (t.kind, matches!(t.body, ClassBody::Long(_))))
    {
        Some((kind, true)) => kind,
        // Short classes and predefined types have the kind of the class that they name.
        _ => cx.kind(base),
    };
    use ClassKind as K;
    let fits = match (text.kind, of_base) {
        (_, K::Class) => true,
        (K::Class, base) => !matches!(base, K::Function { .. }),
        (K::Package, base) => base == K::Package,
        (K::Operator, base) => matches!(base, K::Operator | K::Package),
        (K::Function { .. }, base) => matches!(base, K::Function { .. }),
        (K::Type, base) => base == K::Type,
        (K::Record | K::OperatorRecord, base) => matches!(base, K::Record | K::OperatorRecord),
        (K::Connector | K::ExpandableConnector, base) => matches!(
            base,
            K::Type | K::Record | K::OperatorRecord | K::Connector | K::ExpandableConnector
        ),
        (K::Block, base) => matches!(base, K::Record | K::OperatorRecord | K::Block),
        (K::Model, base) => {
            matches!(base, K::Record | K::OperatorRecord | K::Block | K::Model)
        }
    };
    if let Some(of) = cx.definition(base).cloned()
        && let ClassBody::Long(composition) = &of.body
    {
        check_operator_base(cx.problems, text, &of, composition, span);
    }
    if !fits && !is_empty(cx, base) {
        report_base(cx, text, of_base, base, span);
    }
}

/// Operators belong to one record: it is extended by short class definitions only, and its
/// enclosing class not at all (section 4.6).
fn check_operator_base(
    problems: &mut Problems,
    text: &Class,
    base: &Class,
    composition: &Composition,
    span: Span,
) {
    let inside = composition.elements.iter().find_map(|e| match &e.kind {
        ElementKind::Class(c)
            if c.kind == ClassKind::OperatorRecord && matches!(c.body, ClassBody::Long(_)) =>
        {
            Some(c.name)
        }
        _ => None,
    });
    let (inside, place) = match inside {
        _ if base.kind == ClassKind::OperatorRecord => (None, base.name.span),
        Some(record) => (Some(record.name), record.span),
        None => return,
    };
    let (base, class) = (base.name.name, text.name.name);
    let cause = SpecializedClassCause::OperatorRecordBase { base, class, inside };
    problems.push(
        Diagnostic::new(cause, span)
            .also(place, "declared here")
            .note("the meaning of an operator must not depend on the class that extends it"),
    );
}

/// A class with prefixes of its own must be the only `extends` (section 4.5.2).
pub(crate) fn check_prefixed_base(
    cx: &mut ClassGraph<'_>,
    class: ClassId,
    base: ClassId,
    span: Span,
) {
    let (Some(text), Some(of)) = (cx.definition(class).cloned(), cx.definition(base).cloned())
    else {
        return;
    };
    let ClassBody::Long(composition) = &text.body else { return };
    let ClassBody::Short(short) = &of.body else { return };
    let others = composition.elements.iter().filter(|e| match &e.kind {
        ElementKind::Components(_) => true,
        ElementKind::Extends(extends) => extends.base.span != span,
        _ => false,
    });
    if short.prefix == ast::TypePrefix::default() || others.count() == 0 {
        return;
    }
    cx.problems.push(
        Diagnostic::new(SpecializedClassCause::PrefixedBase { base: of.name.name }, span)
            .also(of.name.span, "declared with a prefix such as `input`"),
    );
}

/// `class A = F` does not make a function of A: only `function A = F` does.
pub(crate) fn check_short_base(cx: &mut ClassGraph<'_>, text: &Class, base: ClassId, span: Span) {
    if text.kind != ClassKind::Class || !matches!(cx.kind(base), ClassKind::Function { .. }) {
        return;
    }
    let of = cx.kind(base);
    report_base(cx, text, of, base, span);
}

/// Whether a class has no elements: icons, which libraries give to classes of any kind.
fn is_empty(cx: &mut ClassGraph<'_>, class: ClassId) -> bool {
    if cx.table_in_progress(class) {
        return false;
    }
    let table = cx.table(class);
    table.scalar.is_none()
        && table.entries.is_empty()
        && table.sections.is_empty()
        && table.external.is_none()
}

fn report_base(cx: &mut ClassGraph<'_>, text: &Class, of: ClassKind, base: ClassId, span: Span) {
    let base = cx.classes[base].full_name.to_string();
    let cause =
        SpecializedClassCause::OtherBase { kind: text.kind, class: text.name.name, of, base };
    cx.problems.push(
        Diagnostic::new(cause, span)
            .label("of another kind")
            .note("a model can extend models, blocks and records; a block cannot extend a model"),
    );
}

/// A public component of a function is an input or an output, if only by its type.
pub(crate) fn report_formal(problems: &mut Problems, function: Name, name: ast::Ident) {
    let cause = SpecializedClassCause::UndirectedFormal { name: name.name, function };
    problems.push(Diagnostic::new(cause, name.span));
}

/// `time` is known in models and blocks only (section 3.6.7).
pub(crate) fn check_time(cx: &mut ClassGraph<'_>, span: Span, scope: Scope) {
    let kind = cx.kind(scope.class);
    if matches!(kind, ClassKind::Model | ClassKind::Block | ClassKind::Class) {
        return;
    }
    cx.problems.push(
        Diagnostic::new(SpecializedClassCause::TimeOutsideModel { kind }, span)
            .label("known in models and blocks only"),
    );
}

/// A class that is a predefined type or an array has no other elements (section 4.5.2).
pub(crate) fn check_simple_type(
    cx: &mut ClassGraph<'_>,
    class: ClassId,
    table: &ClassTable,
    bases: &[ClassId],
) {
    if table.scalar.is_none() && table.dims.is_empty() {
        return;
    }
    let Some(text) = cx.definition(class).cloned() else { return };
    let ClassBody::Long(composition) = &text.body else { return };
    let components =
        composition.elements.iter().any(|e| matches!(e.kind, ElementKind::Components(_)));
    // Bases without anything in them, such as icons, do no harm.
    let mut filled = 0;
    for base in bases {
        let of_base = cx.table(*base);
        filled += usize::from(
            of_base.scalar.is_some() || !of_base.dims.is_empty() || !of_base.entries.is_empty(),
        );
    }
    if !components && filled < 2 {
        return;
    }
    let (class, scalar) = (text.name.name, table.scalar.is_some());
    cx.report(SpecializedClassCause::SimpleBase { class, scalar, components }, text.name.span);
}

pub(crate) fn word(kind: ClassKind) -> &'static str {
    match kind {
        ClassKind::Class => "class",
        ClassKind::Model => "model",
        ClassKind::Block => "block",
        ClassKind::Record => "record",
        ClassKind::OperatorRecord => "operator record",
        ClassKind::Connector => "connector",
        ClassKind::ExpandableConnector => "expandable connector",
        ClassKind::Type => "type",
        ClassKind::Package => "package",
        ClassKind::Function { .. } => "function",
        ClassKind::Operator => "operator",
    }
}
