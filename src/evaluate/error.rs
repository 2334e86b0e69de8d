//! Diagnostics of expressions.

use super::Evaluator;
use crate::base::diag::{Diagnostic, Problems, did_you_mean};
use crate::base::name::Name;
use crate::base::source::Span;
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
        let mut names = Vec::new();
        for name in self.frames.names() {
            names.push(name.to_string());
        }
        let table = self.table_of(scope.instance);
        names.extend(table.entries.iter().map(|e| e.name.name.to_string()));
        names.push("time".into());
        let mut d = Diagnostic::error("MO0202", span, format!("`{wanted}` is not declared"))
            .label("not found");
        d = match did_you_mean(&wanted, names.iter().map(String::as_str)) {
            Some(near) => d.help(format!("did you mean `{near}`?")),
            None => d.help("declare it in this class, or check the spelling"),
        };
        self.problems.push(d);
    }
}
