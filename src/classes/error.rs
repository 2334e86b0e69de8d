//! Diagnostics of classes, modifications and expressions: codes MO0201 to MO0299.

use super::{ClassGraph, ROOT};
use crate::base::diag::{Diagnostic, did_you_mean};
use crate::base::name::Name;
use crate::base::source::Span;
use crate::ir::ast;
use crate::ir::instance::{ClassId, ClassTable, Entry, EntryKind, InstanceId, Scope};

impl ClassGraph<'_> {
    /// Adds an error.
    pub fn error(&mut self, code: &'static str, span: Span, message: impl Into<String>) {
        self.problems.push(Diagnostic::error(code, span, message));
    }

    /// A part of the language that mocc does not have yet.
    pub fn unsupported(&mut self, span: Span, what: &str) {
        self.problems.push(
            Diagnostic::error("MO0200", span, format!("not supported yet: {what}")).help(
                "write it another way for now; the list of what is supported is in README.md",
            ),
        );
    }

    pub(crate) fn report_unknown_class(&mut self, path: &ast::Path, scope: Scope) {
        let Some(first) = path.parts.first() else { return };
        if path.parts.len() == 1 && first.name.as_str() == "Clock" {
            return self.unsupported(path.span, "clocks");
        }
        let mut candidates = Vec::new();
        let mut inside = None;
        if path.parts.len() > 1 {
            // The longest prefix that exists says where to look for near misses.
            for k in (1..path.parts.len()).rev() {
                let prefix = ast::Path { parts: path.parts[..k].to_vec(), ..path.clone() };
                if let Some(class) = self.find_class(&prefix, scope) {
                    inside = Some((prefix.to_string(), path.parts[k]));
                    candidates = self.class_names(class);
                    break;
                }
            }
        }
        if inside.is_none() {
            let mut class = Some(scope.class);
            while let Some(c) = class {
                candidates.extend(self.class_names(c));
                class = self.classes[c].enclosing;
            }
            candidates.extend(self.predefined.keys().map(Name::to_string));
            candidates.sort();
        }
        let (message, span, wanted) = match &inside {
            Some((package, part)) => {
                (format!("there is no class `{}` in `{package}`", part.name), part.span, part.name)
            }
            None => (format!("there is no class `{path}`"), path.span, first.name),
        };
        let mut d = Diagnostic::error("MO0201", span, message).label("not found");
        d = match did_you_mean(&wanted, candidates.iter().map(String::as_str)) {
            Some(near) => d.help(format!("did you mean `{near}`?")),
            None => d.help(
                "check the spelling, or name the folder that holds the library with `--lib DIR`",
            ),
        };
        self.problems.push(d);
    }

    /// Names of the classes in a class, for suggestions.
    fn class_names(&mut self, class: ClassId) -> Vec<String> {
        let full_name = self.classes[class].full_name;
        let mut names = self.library.child_names(&full_name);
        if class != ROOT.class && !self.table_in_progress(class) {
            let table = self.table(class);
            names.extend(
                table
                    .entries
                    .iter()
                    .filter(|e| matches!(e.kind, EntryKind::Class(_)))
                    .map(|e| e.name.name.to_string()),
            );
        }
        names
    }

    /// `a.b` where `a` has no `b`.
    pub(crate) fn report_unknown_member(&mut self, holder: InstanceId, part: &ast::Ident) {
        let kind = self.instances[holder].class.map(|c| self.kind(c));
        if kind == Some(ast::ClassKind::ExpandableConnector) {
            let message =
                format!("the expandable connector `{}` has no `{}`", self.path(holder), part.name);
            self.problems.push(
                Diagnostic::error("MO0242", part.span, message)
                    .label("declared at neither end of a connection")
                    .help("declare it in the connector, or connect it to a declared connector")
                    .note(
                        "a connection adds what the connector at its other end is (section 9.1.3)",
                    ),
            );
            return;
        }
        let table = self.table_of(holder);
        let names: Vec<&str> = table
            .entries
            .iter()
            .filter(|e| e.component.is_some())
            .map(|e| e.name.name.as_str())
            .collect();
        let class = self.instances[holder].class.map(|c| self.classes[c].full_name);
        let message = match class {
            Some(class) => {
                format!("`{}` of class `{class}` has no `{}`", self.path(holder), part.name)
            }
            None => format!("`{}` has no `{}`", self.path(holder), part.name),
        };
        let mut d = Diagnostic::error("MO0202", part.span, message).label("not found");
        d = match did_you_mean(&part.name, names.iter().copied()) {
            Some(near) => d.help(format!("did you mean `{near}`?")),
            None if names.is_empty() => d,
            None => d.help(format!("it has {}", listed(&names))),
        };
        self.problems.push(d);
    }

    pub(crate) fn report_unknown_modifier(
        &mut self,
        class: Option<ClassId>,
        text: Name,
        span: Span,
        table: &ClassTable,
    ) {
        let class = class.map(|c| self.classes[c].full_name);
        let class = class.map_or(String::new(), |c| c.to_string());
        let names: Vec<&str> = table.entries.iter().map(|e| e.name.name.as_str()).collect();
        let mut d = Diagnostic::error(
            "MO0203",
            span,
            format!("class `{class}` has no element `{text}` to modify"),
        )
        .label("not found");
        d = match did_you_mean(&text, names.iter().copied()) {
            Some(near) => d.help(format!("did you mean `{near}`?")),
            None if names.is_empty() => d.help("remove the modification"),
            None => d.help(format!("it has {}", listed(&names))),
        };
        self.problems.push(d);
    }

    pub(crate) fn report_unknown_attribute(&mut self, id: InstanceId, text: Name, span: Span) {
        let attributes = super::attribute::ATTRIBUTES;
        let mut d = Diagnostic::error(
            "MO0203",
            span,
            format!("`{}` has no attribute `{text}`", self.path(id)),
        )
        .label("not an attribute");
        d = match did_you_mean(&text, attributes) {
            Some(near) => d.help(format!("did you mean `{near}`?")),
            None => d.help(format!("attributes are {}", listed(&attributes[..10]))),
        };
        self.problems.push(d);
    }

    pub(crate) fn report_final(&mut self, id: InstanceId, span: Span, closed: Span) {
        self.problems.push(
            Diagnostic::error(
                "MO0209",
                span,
                format!("`{}` is final: it keeps the value it has", self.path(id)),
            )
            .label("another value")
            .also(closed, "its final value")
            .help("remove this value, or `final` where it stands"),
        );
    }

    /// A binding that varies faster than the variable it belongs to.
    pub(crate) fn report_variability(&mut self, id: InstanceId, span: Span, what: &str) {
        let path = self.path(id);
        let constant = self.instances[id].prefix.variability == Some(ast::Variability::Constant);
        let kind = if constant { "constant" } else { "parameter" };
        self.problems.push(
            Diagnostic::error("MO0268", span, format!("{kind} `{path}` is bound to {what}"))
                .label(what)
                .also(self.declared_at(id), "declared here")
                .help(if constant {
                    "use constants only, or make it a parameter"
                } else {
                    "use parameters and constants only, or leave `parameter` out"
                })
                .note("a value may not change faster than what it is bound to (section 3.8)"),
        );
    }

    /// An attribute that varies during simulation.
    pub(crate) fn report_moving_attribute(&mut self, id: InstanceId, attribute: Name, span: Span) {
        let path = self.path(id);
        let help = match attribute.as_str() {
            "start" => "use parameters and constants, or write an initial equation",
            _ => "use parameters and constants, or an `assert`",
        };
        let message =
            format!("`{attribute}` of `{path}` is given a value that changes while the model runs");
        self.problems.push(
            Diagnostic::error("MO0274", span, message)
                .label("changes while the model runs")
                .also(self.declared_at(id), "declared here")
                .help(help)
                .note("attributes are as constant as parameters (section 4.9)"),
        );
    }

    pub(crate) fn report_conditional(&mut self, id: InstanceId, span: Span) {
        let path = self.path(id);
        self.problems.push(
            Diagnostic::error("MO0217", span, format!("`{path}` is conditional, and read as a value"))
                .also(self.declared_at(id), "declared with a condition")
                .help("declare it without condition, or read it inside of a component that has the same condition")
                .note("a conditional component may be modified and connected only (section 4.4.5)"),
        );
    }

    pub(crate) fn report_final_attribute(
        &mut self,
        id: InstanceId,
        attribute: Name,
        span: Span,
        closed: Span,
    ) {
        let path = self.path(id);
        self.problems.push(
            Diagnostic::error(
                "MO0209",
                span,
                format!("attribute `{attribute}` of `{path}` is final"),
            )
            .label("another value")
            .also(closed, "its final value")
            .help("remove this value, or use another type")
            .note("section 7.2.6 of the specification"),
        );
    }

    pub(crate) fn report_duplicate(&mut self, entry: &Entry, before: &ast::Ident) {
        self.problems.push(
            Diagnostic::error(
                "MO0204",
                entry.name.span,
                format!("`{}` is declared twice", entry.name.name),
            )
            .label("second declaration")
            .also(before.span, "first declaration")
            .help("rename or remove one of them"),
        );
    }

    pub(crate) fn report_inherited_duplicate(&mut self, entry: &Entry, before: &ast::Ident) {
        let name = entry.name.name;
        self.problems.push(
            Diagnostic::error(
                "MO0204",
                entry.name.span,
                format!("`{name}` is inherited and declared again in another way"),
            )
            .label("declared again")
            .also(before.span, "inherited from here")
            .help(format!(
                "modify the inherited one, as in `extends ...({name} = ...)`, or rename"
            )),
        );
    }

    pub(crate) fn report_not_replaceable(&mut self, text: Name, span: Span, before: Span) {
        self.problems.push(
            Diagnostic::error("MO0224", span, format!("`{text}` is not replaceable"))
                .label("declared anew")
                .also(before, "declared without `replaceable`")
                .help("write `replaceable` before the declaration, or modify it instead")
                .note("section 7.3.3 of the specification"),
        );
    }

    pub(crate) fn report_incompatible(
        &mut self,
        text: Name,
        span: Span,
        (before, why): (Span, String),
    ) {
        self.problems.push(
            Diagnostic::error(
                "MO0225",
                span,
                format!("what `{text}` is redeclared to does not fit: {why}"),
            )
            .also(before, "what it must fit is declared here")
            .help("use a class that has all that the constraining class has, for instance one that extends it")
            .note("sections 6.4 and 7.3.2 of the specification"),
        );
    }

    /// Only functions have partial derivatives.
    pub(crate) fn report_underived(&mut self, text: &ast::Class, base: ClassId, span: Span) {
        let base = self.classes[base].full_name;
        let message =
            format!("`{base}` is no function: `{}` cannot be its derivative", text.name.name);
        self.problems.push(
            Diagnostic::error("MO0219", span, message)
                .label("not a function")
                .note("section 12.7.2 of the specification"),
        );
    }

    pub(crate) fn report_inheritance_cycle(&mut self, class: ClassId) {
        let span = self.definition(class).map_or(Span::NONE, |t| t.name.span);
        let name = self.classes[class].full_name;
        self.problems.push(
            Diagnostic::error("MO0205", span, format!("`{name}` inherits from itself"))
                .label("needed to find its own bases")
                .help("break the circle of `extends` clauses"),
        );
    }

    pub(crate) fn report_no_inner(&mut self, component: ast::Ident) {
        self.problems.push(
            Diagnostic::error(
                "MO0206",
                component.span,
                format!("there is no `inner` component `{}` around this one", component.name),
            )
            .help("declare one in an enclosing component (section 5.4 of the specification)"),
        );
    }

    pub(crate) fn report_unknown_size(&mut self, component: ast::Ident, span: Span) {
        self.problems.push(
            Diagnostic::error(
                "MO0207",
                component.span,
                format!(
                    "the size of `{}` is left open and has no value to take it from",
                    component.name
                ),
            )
            .also(span, "open size")
            .help("give it a size or a binding"),
        );
    }
}

/// `a, b and c`, at most eight.
pub(crate) fn listed(names: &[&str]) -> String {
    let shown: Vec<String> = names.iter().take(8).map(|n| format!("`{n}`")).collect();
    match shown.split_last() {
        Some((last, rest)) if names.len() > 8 => format!("{}, {last} ...", rest.join(", ")),
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} and {last}", rest.join(", ")),
        None => String::new(),
    }
}
