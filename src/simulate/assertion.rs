//! What the model itself says about its run: assertions and terminations.

use crate::base::diag::{Diagnostic, Severity};
use crate::ir::expr::{Const, ExprId};

use super::error::{Failure, FailureKind};
use super::events::Settled;
use super::explain::Reader;
use super::run::Simulation;

impl Simulation<'_, '_> {
    /// Assertions outside of when-clauses, as evaluated last.
    pub(super) fn check_assertions(&mut self, t: f64) -> Result<(), Failure> {
        for k in 0..self.program.asserts.len() {
            let cells = self.program.asserts[k];
            if cells.at_events || self.model.instance.get(cells.condition) != 0.0 {
                continue;
            }
            let warning = self.program.blocks.dae.asserts[k].assert.warning;
            if !warning {
                return Err(self.assertion(k, t));
            }
            if !std::mem::replace(&mut self.warned[k], true) {
                let failure = self.assertion(k, t);
                let severity = Severity::Warning;
                self.statistics.warnings.push(Diagnostic { severity, ..*failure.diagnostic });
            }
        }
        Ok(())
    }

    fn assertion(&self, k: usize, t: f64) -> Failure {
        let guarded = &self.program.blocks.dae.asserts[k];
        let reader = Reader::new(self.program, &self.model.instance.memory);
        let message = format!("at time {t} s: {}", self.message(guarded.assert.message));
        let diagnostic = Diagnostic::error("MO0912", guarded.origin.span, message)
            .label(format!("`{}` is false", reader.text(guarded.assert.condition)));
        Failure { kind: FailureKind::Assertion, time: t, diagnostic: Box::new(diagnostic) }
    }

    /// The text of a `String` expression.
    fn message(&self, e: ExprId) -> String {
        match self.program.blocks.dae.graph.as_const(e) {
            Some(Const::String(text)) => text.to_string(),
            _ => Reader::new(self.program, &self.model.instance.memory).text(e),
        }
    }

    /// Failed assertions and terminations of an event iteration.
    pub(super) fn act_on(&mut self, settled: Settled, t: f64) -> Result<(), Failure> {
        if let Some(k) = settled.failed {
            return Err(self.assertion(k, t));
        }
        if let Some(k) = settled.terminate {
            let message = self.program.blocks.dae.terminates[k].message;
            self.statistics.terminated = Some(self.message(message));
            self.ended = true;
        }
        Ok(())
    }
}
