//! Failures of a run, reported in the user's names.

pub mod assertion;
pub mod non_finite;
pub mod precondition;

use crate::base::diag::Diagnostic;
use crate::base::name::string_of_id;
use crate::base::source::Span;
use crate::integrate::outcome::Failure as Integration;
use crate::ir::blocks::{Block, Source, Torn};
use crate::ir::expr::VarId;
use crate::ir::program::{DiscreteUnknown, Program, Sequence};
use crate::runtime::machine::{Fault, Machine};

use self::assertion::violated;
use self::non_finite::{Explainer, block, first_source, not_finite, relation_text, source_of};
use super::cause::{NonFinite, RunCause};
use super::event::iterate::EventError;
use super::initialization::StartError;

/// Kind of failure.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FailureKind {
    /// The numerics failed.
    Numerics,
    /// An assertion of the model is violated.
    Assertion,
    /// The settings are out of range.
    Settings,
    /// A bug in mocc.
    Bug,
}

/// A run that ended early.
#[derive(Clone, PartialEq, Debug)]
pub struct Failure {
    /// Its kind.
    pub kind: FailureKind,
    /// Time of the failure, s.
    pub time: f64,
    /// The message.
    pub diagnostic: Box<Diagnostic>,
}

impl Failure {
    /// True if only the sensitivities of the run could not be computed.
    pub fn is_without_derivatives(&self) -> bool {
        self.diagnostic.is(|cause| matches!(cause, RunCause::NoSensitivities { .. }))
    }

    /// True if another method may get past the instant at which the run ended: loops were not solved, or
    /// steps became too small.
    pub fn depends_on_method(&self) -> bool {
        self.kind == FailureKind::Numerics
            && self.diagnostic.is(|cause| {
                !matches!(
                    cause,
                    RunCause::Chattering { .. }
                        | RunCause::PassedThrough { .. }
                        | RunCause::HiddenSwitching { .. }
                        | RunCause::IntegerTooLarge { .. }
                        | RunCause::TooManyTicks { .. }
                        | RunCause::StringTooLong { .. }
                )
            })
    }

    /// A failure of the numerics.
    pub fn numerics(time: f64, diagnostic: Diagnostic) -> Self {
        Failure { kind: FailureKind::Numerics, time, diagnostic: Box::new(diagnostic) }
    }

    /// A violated invariant of mocc.
    pub fn bug(time: f64, what: impl Into<String>) -> Self {
        let diagnostic = Diagnostic::new(RunCause::Bug { what: what.into() }, Span::NONE);
        Failure { kind: FailureKind::Bug, time, diagnostic: Box::new(diagnostic) }
    }

    /// Settings out of range.
    pub fn settings(why: String) -> Self {
        let diagnostic = Diagnostic::new(RunCause::Settings { why }, Span::NONE);
        Failure { kind: FailureKind::Settings, time: 0.0, diagnostic: Box::new(diagnostic) }
    }
}

/// Explains a fault of a tape from the memory at the time of the fault.
pub fn of_fault(machine: &Machine<'_>, fault: Fault, time: f64) -> Failure {
    let program = machine.program;
    let explainer = Explainer::new(program, &machine.fault_memory);
    let diagnostic = match fault {
        Fault::Derivative { state } => {
            let states = &program.blocks.states;
            let sequence = Sequence::Continuous;
            match state.checked_sub(states.len()) {
                None => explainer.not_finite(states[state].derivative, sequence, time),
                Some(k) => {
                    let a = program.algebraics[k];
                    explainer.expression_not_finite(a.residual, a.source, sequence, time)
                }
            }
        }
        Fault::NotFinite { torn_block, residual } => {
            let place = program.routines.torn_blocks[torn_block].place;
            let torn = block(program, place).and_then(|b| torn_of(b, program, torn_block));
            match torn.and_then(|t| t.residuals.get(residual)) {
                Some(r) => explainer.expression_not_finite(r.value, r.source, place.sequence, time),
                None => not_finite(NonFinite::Unnamed("a simultaneous equation"), time),
            }
        }
        Fault::Singular { torn_block, unknown }
            if !is_solved(program, &machine.fault_memory, torn_block) =>
        {
            unsolved(&explainer, program, torn_block, unknown, time)
                .note("the iteration came to a point where no correction is determined")
        }
        Fault::Singular { torn_block, unknown } => {
            let cause = |unknown| RunCause::SingularLoop { time, unknown };
            torn_failure(&explainer, program, torn_block, unknown, cause)
        }
        Fault::Diverged { torn_block, unknown } => {
            unsolved(&explainer, program, torn_block, unknown, time)
        }
        Fault::NotConverged { mixed_block, unknown } => {
            let mixed = &program.routines.mixed_blocks[mixed_block];
            let unknown = match mixed.discrete_unknowns[unknown] {
                DiscreteUnknown::Variable(v, _) => program.name(v).to_owned(),
                DiscreteUnknown::Relation(k, _) => explainer.relation(k),
            };
            let source = block(program, mixed.place).and_then(first_source);
            let span = source.map_or(Span::NONE, |s| explainer.span(s));
            Diagnostic::new(RunCause::MixedLoop { time, unknown }, span)
                .label("equations of this loop have no consistent solution")
        }
        Fault::Assertion { function, message } => {
            let function_info = &program.blocks.dae.functions;
            let (slot, place) = program.routines.functions[function].messages[message];
            let text = string_of_id(machine.fault_memory[slot as usize] as u32);
            let info = function_info.iter().nth(function);
            let function = info.map_or_else(String::new, |f| f.name.to_string());
            let span = info.map_or(Span::NONE, |f| f.span);
            let cause = RunCause::FunctionAssertion { time, function, text: text.to_string() };
            Diagnostic::new(cause, place).also(span, "while this was computed")
        }
        Fault::Sliding { relation } => {
            let span = program.blocks.dae.relations[relation as usize].origin.span;
            let value = NonFinite::Sliding { relation: explainer.relation(relation) };
            Diagnostic::new(RunCause::NotFinite { time, value }, span)
        }
        Fault::NonTerminating { function } => {
            let info = program.blocks.dae.functions.iter().nth(function);
            let function = info.map_or_else(String::new, |f| f.name.to_string());
            let span = info.map_or(Span::NONE, |f| f.span);
            Diagnostic::new(RunCause::NonTerminatingFunction { time, function }, span)
        }
    };
    Failure::numerics(time, diagnostic)
}

/// Explains a failure of the integrator.
pub fn of_integration(machine: &Machine<'_>, failure: Integration, time: f64) -> Failure {
    let program = machine.program;
    let explainer = Explainer::new(program, &machine.memory);
    let state = |component: usize| program.component(component);
    match failure {
        Integration::Options(error) => Failure::settings(error.to_string()),
        Integration::Start { component } => {
            let state = state(component).map_or("", |v| program.name(v)).to_owned();
            let cause = RunCause::NoFiniteStart { time, state };
            Failure::numerics(time, Diagnostic::new(cause, Span::NONE))
        }
        Integration::Eval { .. } | Integration::NonFinite { .. } => {
            if let Some(fault) = machine.fault {
                return of_fault(machine, fault, time);
            }
            let named = match failure {
                Integration::NonFinite { component, .. } => state(component),
                _ => None,
            };
            let diagnostic = match named {
                Some(v) => unbounded(&explainer, program, v, time),
                None => not_finite(NonFinite::Unnamed("a derivative"), time),
            };
            Failure::numerics(time, diagnostic)
        }
        Integration::StepTooSmall { h, component, .. }
        | Integration::NewtonFailed { h, component, .. } => {
            // If the step shrank at the boundary of a domain, report that.
            if let Some(fault) = machine.fault {
                return of_fault(machine, fault, time);
            }
            let cause = |state| RunCause::StepTooSmall { time, step: h, state };
            let diagnostic = at_state(&explainer, program, state(component), cause);
            Failure::numerics(time, diagnostic)
        }
        Integration::Singular { component, .. } => {
            let cause = |state| RunCause::SingularIteration { time, state };
            let diagnostic = at_state(&explainer, program, state(component), cause);
            Failure::numerics(time, diagnostic)
        }
        Integration::TooManySteps { steps, .. } => {
            let cause = RunCause::TooManySteps { time, limit: steps };
            Failure::numerics(time, Diagnostic::new(cause, Span::NONE))
        }
    }
}

/// Explains a failed event iteration or initialization.
pub fn event_failure(machine: &Machine<'_>, why: EventError, t: f64) -> Failure {
    match why {
        EventError::Fault(fault) => of_fault(machine, fault, t),
        EventError::NotConverged(variables, relations) => {
            let program = machine.program;
            let hidden = |v: &&VarId| program.blocks.dae.variables[**v].hidden;
            let all_hidden = variables.iter().all(|v| hidden(&v));
            let shown = variables.iter().filter(|v| all_hidden || !hidden(v));
            let mut names: Vec<String> = shown.map(|v| format!("`{}`", program.name(*v))).collect();
            names.extend(relations.iter().map(|k| format!("`{}`", relation_text(program, *k))));
            let dae = &program.blocks.dae;
            let span = match (variables.first(), relations.first()) {
                (Some(v), _) => {
                    let equation = dae.discrete.iter().find(|q| q.variable == *v);
                    equation.map_or(dae.variables[*v].span, |q| q.origin.span)
                }
                (None, Some(k)) => dae.relations[*k as usize].origin.span,
                _ => Span::NONE,
            };
            let cause = RunCause::EndlessEventIteration { time: t, names };
            Failure::numerics(t, Diagnostic::new(cause, span))
        }
    }
}

/// Explains why a run could not be initialized.
pub fn start_failure(machine: &Machine<'_>, why: StartError, t: f64) -> Failure {
    let program = machine.program;
    match why {
        StartError::NotAnInput(v) => Failure::settings(format!(
            "cannot set `{}` for a run: it is not a parameter or start value of the program",
            program.name(v)
        )),
        StartError::Parameter(v) => {
            let explainer = Explainer::new(program, &machine.fault_memory);
            let value = program.blocks.dae.parameters.iter().find(|p| p.0 == v).map(|p| p.1);
            let diagnostic = match value {
                Some(value) => {
                    let source = Source::Start(v);
                    explainer.expression_not_finite(value, source, Sequence::Initial, t)
                }
                None => not_finite(NonFinite::Unnamed("a parameter"), t),
            };
            Failure::numerics(t, diagnostic)
        }
        StartError::Clock(k) | StartError::Ticks(k, _) => {
            let interval = machine.get(program.events.clocks[k].interval);
            let flag = program.blocks.dae.samples[k].flag;
            let span = program.blocks.dae.variables[flag].span;
            let cause = match why {
                StartError::Ticks(_, ticks) => RunCause::TooManyTicks { interval, ticks },
                _ => RunCause::SampleInterval { interval },
            };
            Failure::numerics(t, Diagnostic::new(cause, span))
        }
        StartError::History(delayed) => {
            let span = program.blocks.dae.variables[delayed].span;
            Failure::numerics(t, Diagnostic::new(RunCause::UnsettledHistory { time: t }, span))
        }
        StartError::Assertion(k) => violated(program, &machine.memory, k, t),
        StartError::Event(u) => event_failure(machine, u, t),
    }
}

/// Warns about an unknown of a linear block whose equations are consistent but do not determine it.
pub fn undetermined(
    machine: &Machine<'_>,
    torn_block: usize,
    unknown: usize,
    time: f64,
) -> Diagnostic {
    let program = machine.program;
    let explainer = Explainer::new(program, &machine.memory);
    let cause = |unknown| RunCause::Undetermined { time, unknown };
    torn_failure(&explainer, program, torn_block, unknown, cause)
        .note("its equations do not contradict each other: the solution nearest to the last one was taken")
}

/// True if the residuals of a torn block vanish: a solution exists but is not unique.
fn is_solved(program: &Program, memory: &[f64], torn_block: usize) -> bool {
    let s = &program.routines.torn_blocks[torn_block];
    s.linear || s.residuals.iter().all(|r| memory[*r as usize] == 0.0)
}

/// Explains an iteration that did not converge, with its last residuals.
fn unsolved(
    explainer: &Explainer<'_>,
    program: &Program,
    torn_block: usize,
    unknown: usize,
    time: f64,
) -> Diagnostic {
    let s = &program.routines.torn_blocks[torn_block];
    let cause = |unknown| RunCause::NoSolution { time, unknown };
    let mut diagnostic = torn_failure(explainer, program, torn_block, unknown, cause);
    let torn = block(program, s.place).and_then(|b| torn_of(b, program, torn_block));
    let residuals = torn.into_iter().flat_map(|t| &t.residuals).zip(&s.residuals);
    for (equation_residual, slot) in residuals.take(5) {
        let equation = explainer.equation(equation_residual.source);
        let residual = explainer.at(*slot);
        diagnostic =
            diagnostic.note(format!("the sides of `{equation}` differ by {residual} at last"));
    }
    if let Some(v) = s.unknowns.get(unknown) {
        diagnostic =
            diagnostic.note(format!("there `{}` = {}", program.name(*v), explainer.value(*v)));
    }
    diagnostic
}

/// Explains a failure of the integrator, at a state if it is known.
fn at_state(
    explainer: &Explainer<'_>,
    program: &Program,
    state: Option<VarId>,
    cause: impl FnOnce(Option<String>) -> RunCause,
) -> Diagnostic {
    match state {
        Some(v) => of_state(explainer, program, v, cause(Some(program.name(v).to_owned()))),
        None => Diagnostic::new(cause(None), Span::NONE),
    }
}

fn unbounded(explainer: &Explainer<'_>, program: &Program, v: VarId, time: f64) -> Diagnostic {
    let value = NonFinite::Derivative { state: program.name(v).to_owned() };
    of_state(explainer, program, v, RunCause::NotFinite { time, value })
}

/// Explains a failure at a state by its declaration and the equation of its derivative.
fn of_state(explainer: &Explainer<'_>, program: &Program, v: VarId, cause: RunCause) -> Diagnostic {
    let variable = &program.blocks.dae.variables[v];
    let derivative = program.blocks.states.iter().find(|s| s.variable == v).map(|s| s.derivative);
    let mut diagnostic = Diagnostic::new(cause, variable.span).label(format!(
        "`{}` = {}",
        variable.name,
        explainer.value(v)
    ));
    if let Some(d) = derivative {
        diagnostic = diagnostic.note(format!("its derivative is {}", explainer.value(d)));
        if let Some(source) = source_of(program, d) {
            diagnostic = diagnostic.also(explainer.span(source), "its derivative comes from here");
        }
    }
    diagnostic
}

fn torn_failure(
    explainer: &Explainer<'_>,
    program: &Program,
    torn_block: usize,
    unknown: usize,
    cause: impl FnOnce(String) -> RunCause,
) -> Diagnostic {
    let s = &program.routines.torn_blocks[torn_block];
    let v = s.unknowns[unknown.min(s.unknowns.len().saturating_sub(1))];
    let torn = block(program, s.place).and_then(|b| torn_of(b, program, torn_block));
    let cause = cause(program.name(v).to_owned());
    let mut diagnostic = match torn.and_then(|t| t.residuals.get(unknown)) {
        Some(r) => {
            Diagnostic::new(cause, explainer.span(r.source)).label(explainer.equation(r.source))
        }
        None => Diagnostic::new(cause, Span::NONE),
    };
    for other in s.unknowns.iter().filter(|u| **u != v).take(5) {
        diagnostic = diagnostic.note(format!(
            "together with `{}` = {}",
            program.name(*other),
            explainer.value(*other)
        ));
    }
    diagnostic
}

/// The torn block with this number within its outermost block.
fn torn_of<'a>(outer: &'a Block, program: &Program, torn_block: usize) -> Option<&'a Torn> {
    match outer {
        Block::Torn(t) => {
            (t.unknowns == program.routines.torn_blocks[torn_block].unknowns).then_some(t)
        }
        Block::Mixed(parts) => parts.iter().find_map(|p| torn_of(p, program, torn_block)),
        Block::Assign(_) => None,
    }
}
