//! Reports assertions and terminations of the model, and unknowns that it does not determine.

use crate::base::diag::{Diagnostic, Severity};
use crate::base::index::Id;
use crate::base::name::string_of_id;
use crate::ir::expr::{Const, ExprId, Node};
use crate::ir::flat::AssertionLevel;
use crate::ir::program::Program;

use super::non_finite::Explainer;
use super::{Failure, FailureKind, of_fault, undetermined};
use crate::simulate::cause::RunCause;
use crate::simulate::event::iterate::EventEffects;
use crate::simulate::run::Simulation;

impl Simulation<'_, '_> {
    /// Checks assertions outside of when-clauses at the end of the last step.
    pub(crate) fn check_assertions_of_step(&mut self) -> Result<(), Failure> {
        let t = self.stepper.t();
        // Event location has already evaluated them, if there are relations.
        if self.locator.is_empty() && !self.program.events.asserts.is_empty() {
            let evaluated = self.system.evaluate_roots_clamped(t, self.stepper.y());
            evaluated.map_err(|f| of_fault(&self.system.machine, f, t))?;
        }
        self.check_assertions(t)
    }

    /// Checks assertions outside of when-clauses at the last evaluation.
    pub(crate) fn check_assertions(&mut self, t: f64) -> Result<(), Failure> {
        for k in 0..self.program.events.asserts.len() {
            let slots = self.program.events.asserts[k];
            if slots.at_events || self.system.machine.get(slots.condition) != 0.0 {
                continue;
            }
            let assert = &self.program.blocks.dae.asserts[k].assert;
            if assert.level == AssertionLevel::Error {
                return Err(self.assertion(k, t));
            }
            if !self.reported_asserts[k] {
                let text = message_text(self.program, &self.system.machine.memory, assert.message);
                self.report(k, t, &text);
            }
        }
        Ok(())
    }

    /// Reports the message of an assertion that is not an error: prints it, or warns once.
    fn report(&mut self, k: usize, t: f64, text: &str) {
        let is_repeated = std::mem::replace(&mut self.reported_asserts[k], true);
        match self.program.blocks.dae.asserts[k].assert.level {
            AssertionLevel::Print(file) => self.sink.print(text, file.as_str()),
            _ if is_repeated => {}
            _ => {
                let memory = &self.system.machine.memory;
                let warning = diagnostic(self.program, memory, k, t, text.to_owned());
                self.statistics.warnings.push(warning.with_severity(Severity::Warning));
            }
        }
    }

    fn assertion(&self, k: usize, t: f64) -> Failure {
        violated(self.program, &self.system.machine.memory, k, t)
    }

    /// Warns once about an unknown that its equations did not determine during the last step.
    pub(crate) fn warn_of_undetermined(&mut self, t: f64) {
        let Some((torn_block, unknown)) = self.system.machine.undetermined.take() else { return };
        let variable = self.program.routines.torn_blocks[torn_block].unknowns[unknown];
        if self.program.blocks.undetermined.contains(&variable) {
            return; // Reported by the structural analysis.
        }
        let is_undetermined = |cause: &RunCause| matches!(cause, RunCause::Undetermined { .. });
        let is_reported = self.statistics.warnings.iter().any(|w| w.is(is_undetermined));
        if !is_reported {
            let warning = undetermined(&self.system.machine, torn_block, unknown, t);
            self.statistics.warnings.push(warning);
        }
    }

    /// Handles violated assertions and terminations of an event iteration.
    pub(crate) fn handle_effects(&mut self, effects: EventEffects, t: f64) -> Result<(), Failure> {
        self.warn_of_undetermined(t);
        for (k, text) in std::mem::take(&mut self.system.machine.assertion_messages) {
            self.report(k, t, &text);
        }
        if let Some(k) = effects.failed {
            return Err(self.assertion(k, t));
        }
        if let Some(k) = effects.terminate {
            let message = self.program.blocks.dae.terminates[k].message;
            self.statistics.terminated =
                Some(message_text(self.program, &self.system.machine.memory, message));
            self.ended = true;
        }
        Ok(())
    }
}

/// The failure of assertion `k` of the model.
pub fn violated(program: &Program, memory: &[f64], k: usize, t: f64) -> Failure {
    let text = message_text(program, memory, program.blocks.dae.asserts[k].assert.message);
    let diagnostic = diagnostic(program, memory, k, t, text);
    Failure { kind: FailureKind::Assertion, time: t, diagnostic: Box::new(diagnostic) }
}

/// Reports that assertion `k` is violated, with its message.
fn diagnostic(program: &Program, memory: &[f64], k: usize, time: f64, text: String) -> Diagnostic {
    let guarded = &program.blocks.dae.asserts[k];
    let label = match message_of_loop(program, memory, guarded.assert.message) {
        Some(_) => "false in an iteration of its loop".to_owned(),
        None => {
            let condition = Explainer::new(program, memory).text(guarded.assert.condition);
            format!("`{condition}` is false")
        }
    };
    Diagnostic::new(RunCause::Assertion { time, text }, guarded.origin.span).label(label)
}

/// The value of a `String` expression.
pub fn message_text(program: &Program, memory: &[f64], e: ExprId) -> String {
    match program.blocks.dae.graph.as_const(e) {
        Some(Const::String(text)) => text.to_string(),
        _ => match message_of_loop(program, memory, e) {
            Some(text) => text,
            None => Explainer::new(program, memory).message(e),
        },
    }
}

/// The message of a function that checks the assertions of a loop: it comes after the output that says whether
/// the assertion holds.
fn message_of_loop(program: &Program, memory: &[f64], e: ExprId) -> Option<String> {
    let Node::Call { function, output, .. } = program.blocks.dae.graph.node(e) else { return None };
    let (holds, message) = ((output as usize).checked_sub(1)?, output as usize);
    let calls = program.routines.calls.iter();
    let mut of_function = calls.filter(|c| c.function == function.idx() && c.partial.is_none());
    let violated = of_function.find(|c| memory[c.results[holds] as usize] == 0.0)?;
    Some(string_of_id(memory[violated.results[message] as usize] as u32).to_string())
}
