//! Diagnostics of expressions.

use std::path::Path;

use super::Evaluator;
use super::cause::array::{ArrayCause, Pair};
use super::cause::call::{CallCause, Takes};
use super::cause::name::NameCause;
use super::cause::types::{Expected, TypeCause};
use super::value::Value;
use crate::base::diag::{Diagnostic, Problems, did_you_mean};
use crate::base::name::Name;
use crate::base::source::{SETTING, SourceFile, Span};
use crate::classes::cause::{Alternatives, ClassCause, Holder};
use crate::ir::ast::Ident;
use crate::ir::instance::Scope;

impl Evaluator<'_> {
    /// Runs something; its problems are returned instead of reported.
    pub(super) fn collect_problems<T>(
        &mut self,
        act: impl FnOnce(&mut Self) -> T,
    ) -> (T, Problems) {
        let before = std::mem::take(self.problems);
        let result = act(self);
        (result, std::mem::replace(self.problems, before))
    }

    /// A name in an expression that is not declared.
    pub(crate) fn report_unknown_name(&mut self, wanted: Name, span: Span, scope: Scope) {
        // A function may be executed very often.
        let is_same = |d: &Diagnostic| {
            let is_name = |cause: &NameCause| matches!(cause, NameCause::UnknownName { .. });
            d.primary.0 == span && d.is(is_name)
        };
        if self.frames.in_function() && self.problems.iter().any(is_same) {
            return;
        }
        let mut names = Vec::new();
        for name in self.frames.names() {
            names.push(name.to_string());
        }
        let table = self.table_of(scope.instance);
        if table.lacks_base {
            return;
        }
        names.extend(table.entries.iter().map(|e| e.name.name.to_string()));
        names.push("time".into());
        let near = did_you_mean(&wanted, names.iter().map(String::as_str)).map(str::to_string);
        let is_setting = |file: &SourceFile| file.path == Path::new(SETTING);
        let unquoted = self.class_graph.sources.get(span.file).is_some_and(is_setting);
        let cause = NameCause::UnknownName { name: wanted, near };
        let mut diagnostic = Diagnostic::new(cause, span).label("not found");
        if unquoted {
            diagnostic = diagnostic.note(format!("a text is written in quotes: `\"{wanted}\"`"));
        }
        self.problems.push(diagnostic);
    }

    /// `record.part` where the record has no such field.
    pub(super) fn report_unknown_field(&mut self, record: Name, value: &Value, part: Ident) {
        let names: Vec<&str> = match value {
            Value::Record(record) => record.fields.iter().map(|(n, _)| n.as_str()).collect(),
            _ => Vec::new(),
        };
        let others = Alternatives::of(part.name, &names);
        let holder = Holder::Named(record.to_string());
        self.report(ClassCause::UnknownElement { holder, name: part.name, others }, part.span);
    }

    /// A value that is not of the expected type.
    pub(crate) fn report_type(&mut self, expected: Expected, value: &Value, span: Span) {
        let found = self.described(value);
        self.report(TypeCause::WrongType { expected, found }, span);
    }

    /// The type of a value in words.
    pub(crate) fn described(&self, value: &Value) -> String {
        match value {
            Value::Scalar(e) => crate::symbolic::print::type_name(&self.graph, self.graph.ty(*e)),
            Value::Array(a) => format!("an array of size {:?}", a.dims),
            Value::Record(_) => "a record".to_string(),
            Value::Tuple(_) => "a list of values".to_string(),
            Value::Function(_) => "a function".to_string(),
        }
    }

    /// Two values whose sizes must be equal and are not.
    pub(crate) fn report_sizes(&mut self, of: Pair, left: &Value, right: &Value, span: Span) {
        let (left, right) = (left.dims().to_vec(), right.dims().to_vec());
        self.report(ArrayCause::SizesDiffer { of, left, right }, span);
    }

    /// The wrong number of arguments of a built-in function, whose call is at `span`.
    pub(super) fn wrong_arguments(&mut self, span: Span, takes: &'static str) {
        let function = self.called_name(span);
        self.report(CallCause::WrongArguments { function, takes: Takes::These(takes) }, span);
    }

    /// The name before the arguments of the call at `span`.
    pub(super) fn called_name(&self, span: Span) -> String {
        let call = self.sources.text(span).unwrap_or_default();
        call.split('(').next().unwrap_or_default().trim().to_string()
    }
}
