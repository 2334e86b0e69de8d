//! Diagnostics of classes: what is around the place is put into the causes here.

use super::cause::{Alternatives, ClassCause, Holder, Incompatibility, Varying};
use super::unsupported::{Construct, LanguageCause};
use super::{ClassGraph, ROOT};
use crate::base::cause::Cause;
use crate::base::diag::{Diagnostic, Severity, did_you_mean};
use crate::base::name::Name;
use crate::base::source::Span;
use crate::ir::ast;
use crate::ir::instance::{ClassId, ClassTable, Entry, EntryKind, InstanceId, Scope};

impl ClassGraph<'_> {
    /// Reports a cause that needs neither labels nor further spans.
    pub fn report(&mut self, cause: impl Cause, span: Span) {
        self.problems.push(Diagnostic::new(cause, span));
    }

    /// True if an import clause around `scope` names a class of this name: that it does not exist was
    /// reported there.
    fn is_of_missing_import(&self, wanted: Name, scope: Scope) -> bool {
        let mut class = Some(scope.class);
        while let Some(at) = class {
            let composition = self.definition(at).map(|text| &text.body);
            if let Some(ast::ClassBody::Long(composition)) = composition {
                let imports = composition.elements.iter().filter_map(|e| match &e.kind {
                    ast::ElementKind::Import(import) => Some(import),
                    _ => None,
                });
                let gives = |import: &ast::Import| match &import.form {
                    ast::ImportForm::Qualified => {
                        let own = import.path.parts.last();
                        // Its own path may begin with the name that it gives.
                        import.path.parts.len() > 1 && own.is_some_and(|p| p.name == wanted)
                    }
                    ast::ImportForm::Renamed(name) => name.name == wanted,
                    ast::ImportForm::List(names) => names.iter().any(|n| n.name == wanted),
                    ast::ImportForm::All => false,
                };
                if imports.into_iter().any(gives) {
                    return true;
                }
            }
            class = self.classes[at].enclosing;
        }
        false
    }

    /// Reports a construct that mocc does not have yet.
    pub fn unsupported(&mut self, span: Span, construct: Construct) {
        self.report(LanguageCause::Unsupported { construct }, span);
    }

    pub(crate) fn report_unknown_class(&mut self, path: &ast::Path, scope: Scope) {
        let Some(first) = path.parts.first() else { return };
        if self.is_of_missing_import(first.name, scope) {
            return;
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
        let (path, inside, span, wanted) = match inside {
            Some((package, part)) => (part.name.to_string(), Some(package), part.span, part.name),
            None => (path.to_string(), None, path.span, first.name),
        };
        let near = did_you_mean(&wanted, candidates.iter().map(String::as_str)).map(str::to_string);
        let cause = ClassCause::UnknownClass { path, inside, near };
        self.problems.push(Diagnostic::new(cause, span).label("not found"));
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
            let cause = ClassCause::UnknownBusVariable { bus: self.path(holder), name: part.name };
            self.problems.push(
                Diagnostic::new(cause, part.span)
                    .label("declared at neither end of a connection")
                    .note("a connection adds the variables of the connector at its other end"),
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
        let holder = Holder::Component(self.path(holder), class);
        let others = Alternatives::of(part.name, &names);
        let cause = ClassCause::UnknownElement { holder, name: part.name, others };
        self.problems.push(Diagnostic::new(cause, part.span).label("not found"));
    }

    /// Refuses the modification of an element that is a package or a function: calls and constants do not see it.
    pub(crate) fn refuse_modified_class(&mut self, entry: &Entry, span: Span) {
        let ast::ElementKind::Class(class) = &entry.element.kind else { return };
        if matches!(class.kind, ast::ClassKind::Package | ast::ClassKind::Function { .. }) {
            self.unsupported(span, Construct::ModifiedClass);
        }
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
        let others = Alternatives::of(text, &names);
        let cause = ClassCause::UnknownModifiedElement { class, name: text, others };
        self.problems.push(Diagnostic::new(cause, span).label("not found"));
    }

    /// `path` is that of a variable, or the name of its type.
    pub(crate) fn report_unknown_attribute(&mut self, path: String, text: Name, span: Span) {
        let attributes = super::attribute::ATTRIBUTES;
        let others = Alternatives::of(text, &attributes);
        let cause = ClassCause::UnknownAttribute { path, name: text, others };
        self.problems.push(Diagnostic::new(cause, span).label("not an attribute"));
    }

    /// A final variable, or a final attribute of one, that is given another value.
    pub(crate) fn report_final(
        &mut self,
        id: InstanceId,
        attribute: Option<Name>,
        span: Span,
        closed: Span,
    ) {
        let cause = ClassCause::Final { path: self.path(id), attribute };
        self.problems.push(
            Diagnostic::new(cause, span).label("another value").also(closed, "its final value"),
        );
    }

    /// A binding that varies faster than the variable it belongs to.
    pub(crate) fn report_variability(&mut self, id: InstanceId, span: Span, to: Varying) {
        let kind = match self.instances[id].prefix.variability {
            Some(ast::Variability::Constant) => ast::Variability::Constant,
            _ => ast::Variability::Parameter,
        };
        let cause = ClassCause::VaryingBinding { kind, path: self.path(id), to };
        self.problems.push(
            Diagnostic::new(cause, span)
                .label(to.to_string())
                .also(self.declared_at(id), "declared here")
                .note("a value may not vary more than the component that it is bound to"),
        );
    }

    /// An attribute that varies during simulation.
    pub(crate) fn report_moving_attribute(&mut self, id: InstanceId, attribute: Name, span: Span) {
        let cause = ClassCause::VaryingAttribute { attribute, path: self.path(id) };
        self.problems.push(
            Diagnostic::new(cause, span)
                .label("changes during simulation")
                .also(self.declared_at(id), "declared here"),
        );
    }

    pub(crate) fn report_conditional(&mut self, id: InstanceId, span: Span, severity: Severity) {
        let cause = ClassCause::ConditionalRead { path: self.path(id) };
        self.problems.push(
            Diagnostic::new(cause, span)
                .with_severity(severity)
                .also(self.declared_at(id), "declared with a condition")
                .note("a conditional component may be modified and connected only"),
        );
    }

    pub(crate) fn report_duplicate(&mut self, entry: &Entry, before: &ast::Ident) {
        let cause = ClassCause::DeclaredTwice { name: entry.name.name };
        self.problems.push(
            Diagnostic::new(cause, entry.name.span)
                .label("second declaration")
                .also(before.span, "first declaration"),
        );
    }

    pub(crate) fn report_inherited_duplicate(&mut self, entry: &Entry, before: &ast::Ident) {
        let cause = ClassCause::InheritedTwice { name: entry.name.name };
        self.problems.push(
            Diagnostic::new(cause, entry.name.span)
                .label("declared again")
                .also(before.span, "inherited from here"),
        );
    }

    pub(crate) fn report_modified_differently(
        &mut self,
        name: Name,
        before: &[Span],
        later: &[Span],
    ) {
        let places = [later, before].map(|spans| spans.first().copied());
        let (Some(span), other) = (places[0].or(places[1]), places[0].and(places[1])) else {
            return;
        };
        let mut report =
            Diagnostic::new(ClassCause::ModifiedTwice { name }, span).label("modified here");
        if let Some(other) = other {
            report = report.also(other, "and in another way here");
        }
        self.problems.push(report);
    }

    pub(crate) fn report_not_replaceable(&mut self, name: Name, span: Span, before: Span) {
        self.problems.push(
            Diagnostic::new(ClassCause::NotReplaceable { name }, span)
                .label("redeclared")
                .also(before, "declared without `replaceable`"),
        );
    }

    pub(crate) fn report_incompatible(
        &mut self,
        name: Name,
        span: Span,
        (before, why): (Span, Incompatibility),
    ) {
        self.problems.push(
            Diagnostic::new(ClassCause::IncompatibleRedeclaration { name, why }, span)
                .also(before, "its constraining type is declared here"),
        );
    }

    /// Only functions have partial derivatives.
    pub(crate) fn report_underived(&mut self, text: &ast::Class, base: ClassId, span: Span) {
        let base = self.classes[base].full_name.to_string();
        let cause = ClassCause::DerivativeOfOther { base, name: text.name.name };
        self.problems.push(Diagnostic::new(cause, span).label("not a function"));
    }

    pub(crate) fn report_inheritance_cycle(&mut self, class: ClassId) {
        let span = self.definition(class).map_or(Span::NONE, |t| t.name.span);
        let class = self.classes[class].full_name.to_string();
        self.problems.push(
            Diagnostic::new(ClassCause::InheritanceCycle { class }, span)
                .label("needed to find its own bases"),
        );
    }

    pub(crate) fn report_no_inner(&mut self, component: ast::Ident) {
        self.report(ClassCause::NoInner { name: component.name }, component.span);
    }

    pub(crate) fn report_unknown_size(&mut self, component: ast::Ident, span: Span) {
        let cause = ClassCause::UnknownSize { name: component.name };
        self.problems.push(Diagnostic::new(cause, component.span).also(span, "open size"));
    }
}
