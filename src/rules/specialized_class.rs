//! Restrictions of the specialised classes (sections 4.6, 4.8 and 7.1.3 of the specification).

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

/// Checks the definition of a class.
pub(crate) fn check_definition(problems: &mut Problems, text: &Class) {
    check_name(problems, text.name.name, text.name.span, false);
    match &text.body {
        ClassBody::Enumeration(Some(literals)) => {
            for (k, literal) in literals.iter().enumerate() {
                if let Some(before) =
                    literals[..k].iter().find(|l| l.name.name == literal.name.name)
                {
                    let message = format!("literal `{}` stands here twice", literal.name.name);
                    problems.push(
                        Diagnostic::error("MO0226", literal.name.span, message)
                            .also(before.name.span, "first")
                            .help("give one of them another name (section 4.9.5)"),
                    );
                }
                if ATTRIBUTES.contains(&literal.name.name.as_str()) {
                    let message =
                        format!("`{}` is an attribute of enumerations", literal.name.name);
                    problems.push(
                        Diagnostic::error("MO0226", literal.name.span, message)
                            .help("give the literal another name (section 4.9.5)"),
                    );
                }
            }
        }
        ClassBody::Long(composition) => check_parts(problems, text, composition),
        _ => {}
    }
}

fn check_name(problems: &mut Problems, text: Name, span: Span, component: bool) {
    if PREDEFINED.contains(&text.as_str()) || component && text == STATE_SELECT {
        let message = format!("`{text}` is the name of a predefined type");
        problems.push(
            Diagnostic::error("MO0226", span, message).help("choose another name (section 4.9)"),
        );
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
        let what = if equations { "equations" } else { "algorithms" };
        let where_to = match () {
            () if connector => "write them in the model that has the connector",
            () if record => "write them in the model that has the record",
            () => "write an `algorithm`",
        };
        report(problems, text.name.span, format!("{} `{name}` has {what}", word(kind)), where_to);
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
        let path = first.name;
        let say = |what: &str| format!("`{path}` of {} `{name}` is {what}", word(kind));
        if (connector || record) && (element.inner || element.outer) {
            let what = if element.inner { "`inner`" } else { "`outer`" };
            report(problems, first.span, say(what), "declare it in a model");
        }
        if (connector || record) && element.protected {
            report(problems, first.span, say("protected"), "make it public");
        }
        if record && (clause.prefix.connection.is_some() || clause.prefix.causality.is_some()) {
            let what = match (clause.prefix.connection, clause.prefix.causality) {
                (Some(ConnectionPrefix::Flow), _) => "a `flow` variable",
                (Some(ConnectionPrefix::Stream), _) => "a `stream` variable",
                (None, Some(Causality::Input)) => "an `input`",
                _ => "an `output`",
            };
            report(problems, first.span, say(what), "use a connector, or leave the prefix out");
        }
        if !(connector || record) && clause.prefix.connection == Some(ConnectionPrefix::Stream) {
            let what = "a `stream` variable";
            report(problems, first.span, say(what), "declare it in a connector");
        }
        if function && element.protected && clause.prefix.causality.is_some() {
            let what = "an input or output, and protected";
            report(problems, first.span, say(what), "make it public, or leave the prefix out");
        }
        if kind == ClassKind::Package && clause.prefix.variability != Some(Variability::Constant) {
            report(
                problems,
                first.span,
                say("no constant"),
                "declare it `constant`, or make the package a model",
            );
        }
    }
}

/// A function has one algorithm, and not to find its start (section 12.2).
fn check_sections(problems: &mut Problems, text: &Class, composition: &Composition) {
    let name = text.name.name;
    for (k, section) in composition.algorithms.iter().enumerate() {
        let (what, help) = match () {
            () if section.initial => ("an initial algorithm", "write `algorithm`"),
            () if k > 0 => ("more than one algorithm", "put the statements into one"),
            () => continue,
        };
        problems.push(
            Diagnostic::error("MO0226", section.span, format!("function `{name}` has {what}"))
                .also(text.name.span, "declared here")
                .help(help)
                .note("section 12.2 of the specification"),
        );
    }
}

/// An operator holds functions (section 4.7).
fn check_operator(problems: &mut Problems, operator: Name, element: &ast::Element) {
    let wrong = match &element.kind {
        ElementKind::Class(c) => !matches!(c.kind, ClassKind::Function { .. }),
        ElementKind::Components(_) => true,
        ElementKind::Import(_) | ElementKind::Extends(_) => false,
    };
    for (declared, at) in element.names().into_iter().filter(|_| wrong) {
        report(
            problems,
            at,
            format!("`{declared}` of operator `{operator}` is no function"),
            "declare it beside the operator, in the record",
        );
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
        report(
            problems,
            second.span,
            format!("constructor `{}` has a second output, `{}`", function.name.name, second.name),
            "leave the record as its only output",
        );
    }
}

fn report(problems: &mut Problems, span: Span, message: String, help: &str) {
    problems.push(
        Diagnostic::error("MO0226", span, message)
            .help(help)
            .note("kinds of classes differ in what they may hold (section 4.7)"),
    );
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
    if !fits {
        let base = cx.classes[base].full_name;
        let message = format!(
            "{} `{}` cannot extend {} `{base}`",
            word(text.kind),
            text.name.name,
            word(of_base)
        );
        cx.problems.push(
            Diagnostic::error("MO0227", span, message)
                .label("of another kind")
                .help("extend a class of the same kind, or declare a component of it")
                .note(
                    "a model extends models, blocks and records, a block no model (section 7.1.3)",
                ),
        );
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
    let (why, help, place) = match inside {
        _ if base.kind == ClassKind::OperatorRecord => (
            format!("operator record `{}` cannot be extended", base.name.name),
            format!("write `operator record {} = {}(...)`", text.name.name, base.name.name),
            base.name.span,
        ),
        Some(record) => (
            format!(
                "`{}` cannot be extended: it holds operator record `{}`",
                base.name.name, record.name
            ),
            "move the operator record to a package of its own".to_string(),
            record.span,
        ),
        None => return,
    };
    problems.push(
        Diagnostic::error("MO0227", span, why)
            .also(place, "declared here")
            .help(help)
            .note("what an operator does must not depend on who extends it (section 4.7)"),
    );
}

/// A class with prefixes of its own must be the only `extends` (section 4.6).
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
    let message = format!("`{}` has a prefix, and is extended beside other things", of.name.name);
    cx.problems.push(
        Diagnostic::error("MO0227", span, message)
            .also(of.name.span, "declared with a prefix such as `input`")
            .help("declare a component of the class")
            .note("section 4.6.2 of the specification"),
    );
}

/// `class A = F` does not make a function of A: only `function A = F` does.
pub(crate) fn check_short_base(cx: &mut ClassGraph<'_>, text: &Class, base: ClassId, span: Span) {
    if text.kind != ClassKind::Class || !matches!(cx.kind(base), ClassKind::Function { .. }) {
        return;
    }
    let base = cx.classes[base].full_name;
    let message = format!("class `{}` cannot extend function `{base}`", text.name.name);
    cx.problems.push(
        Diagnostic::error("MO0227", span, message)
            .label("of another kind")
            .help(format!("write `function {} = ...`", text.name.name))
            .note("section 7.1.3 of the specification"),
    );
}

/// A public component of a function is an input or an output, if only by its type.
pub(crate) fn report_formal(problems: &mut Problems, function: Name, name: ast::Ident) {
    report(
        problems,
        name.span,
        format!("`{}` of function `{function}` is neither input nor output, and public", name.name),
        "declare it after `protected`",
    );
}

/// `time` is known in models and blocks only (section 3.6.7).
pub(crate) fn check_time(cx: &mut ClassGraph<'_>, span: Span, scope: Scope) {
    let kind = cx.kind(scope.class);
    if matches!(kind, ClassKind::Model | ClassKind::Block | ClassKind::Class) {
        return;
    }
    cx.problems.push(
        Diagnostic::error("MO0226", span, format!("`time` in a {}", word(kind)))
            .label("known in models and blocks only")
            .help("give it from outside: as an input, or by a modification in a model")
            .note("section 3.6.7 of the specification"),
    );
}

/// A class that is a predefined type or an array has no other elements (section 7.1.3).
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
    let what = if table.scalar.is_some() { "a predefined type" } else { "an array" };
    let more = if components { "has components" } else { "another class" };
    let message = format!("`{}` extends {what}, and {more} besides", text.name.name);
    cx.problems.push(
        Diagnostic::error("MO0227", text.name.span, message)
            .help("declare a component of the type instead of extending it")
            .note("section 7.1.3 of the specification"),
    );
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
