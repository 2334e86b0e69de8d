//! Failures of a run, reported in the user's names.

pub mod assertion;
pub mod non_finite;
pub mod precondition;

use crate::base::diag::{Diagnostic, Severity};
use crate::base::name::string_of_id;
use crate::base::source::Span;
use crate::integrate::outcome::Failure as Integration;
use crate::ir::blocks::{Block, Source, Torn};
use crate::ir::expr::VarId;
use crate::ir::program::{DiscreteUnknown, Program, Sequence};
use crate::runtime::machine::{Fault, Machine};

use self::assertion::violated;
use self::non_finite::{Explainer, block, first_source, relation_text, source_of};
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
        self.diagnostic.code == "MO0917"
    }

    /// A failure of the numerics.
    pub fn numerics(time: f64, diagnostic: Diagnostic) -> Self {
        Failure { kind: FailureKind::Numerics, time, diagnostic: Box::new(diagnostic) }
    }

    /// A violated invariant of mocc.
    pub fn bug(time: f64, what: impl Into<String>) -> Self {
        let diagnostic = Diagnostic::error("MO0999", Span::NONE, what)
            .help("this is a bug in mocc, please report it with the model");
        Failure { kind: FailureKind::Bug, time, diagnostic: Box::new(diagnostic) }
    }

    /// Settings out of range.
    pub fn settings(what: String) -> Self {
        let diagnostic = Diagnostic::error("MO0901", Span::NONE, what);
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
                None => explainer.plain("a simultaneous equation is not finite", time),
            }
        }
        Fault::Singular { torn_block, unknown }
            if !is_solved(program, &machine.fault_memory, torn_block) =>
        {
            unsolved(&explainer, program, torn_block, unknown, time)
                .note("the iteration came to a point where no correction is determined")
        }
        Fault::Singular { torn_block, unknown } => {
            let text = |v: &str| {
                format!(
                    "at time {time} s the equations do not determine `{v}`: their matrix is singular"
                )
            };
            torn_failure(&explainer, program, torn_block, unknown, "MO0903", &text)
                .help("check whether a coefficient of this variable becomes zero here")
        }
        Fault::Diverged { torn_block, unknown } => {
            unsolved(&explainer, program, torn_block, unknown, time)
        }
        Fault::NotConverged { mixed_block, unknown } => {
            let mixed = &program.routines.mixed_blocks[mixed_block];
            let what = match mixed.discrete_unknowns[unknown] {
                DiscreteUnknown::Variable(v, _) => format!("`{}`", program.name(v)),
                DiscreteUnknown::Relation(k, _) => format!("`{}`", explainer.relation(k)),
            };
            let source = block(program, mixed.place).and_then(first_source);
            let span = source.map_or(Span::NONE, |s| explainer.span(s));
            let message = format!("at time {time} s {what} does not come to rest");
            Diagnostic::error("MO0905", span, message)
                .label("equations of this loop have no consistent solution")
                .help("break the loop between the discrete and the continuous equations by `pre`")
        }
        Fault::Assertion { function, message } => {
            let function_info = &program.blocks.dae.functions;
            let (slot, place) = program.routines.functions[function].messages[message];
            let text = string_of_id(machine.fault_memory[slot as usize] as u32);
            let info = function_info.iter().nth(function);
            let name = info.map_or("", |f| f.name.as_str());
            let span = info.map_or(Span::NONE, |f| f.span);
            let message = format!("at time {time} s an assertion in `{name}` failed: {text}");
            Diagnostic::error("MO0906", place, message).also(span, "while this was computed")
        }
        Fault::NonTerminating { function } => {
            let info = program.blocks.dae.functions.iter().nth(function);
            let name = info.map_or("", |f| f.name.as_str());
            let span = info.map_or(Span::NONE, |f| f.span);
            let message = format!("at time {time} s function `{name}` does not return");
            Diagnostic::error("MO0907", span, message)
                .help("check the condition that ends its loop, or its calls of itself")
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
            let name = state(component).map_or("", |v| program.name(v)).to_owned();
            let message = format!("at time {time} s `{name}` has no finite start value");
            Failure::numerics(time, Diagnostic::error("MO0908", Span::NONE, message))
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
                None => explainer.plain("a derivative is not finite", time),
            };
            Failure::numerics(time, diagnostic)
        }
        Integration::StepTooSmall { h, component, .. }
        | Integration::NewtonFailed { h, component, .. } => {
            // If the step shrank at the boundary of a domain, report that.
            if let Some(fault) = machine.fault {
                return of_fault(machine, fault, time);
            }
            let diagnostic = match state(component) {
                Some(v) => stuck(&explainer, program, v, h, time),
                None => explainer.plain("the step became too small", time),
            };
            Failure::numerics(time, diagnostic)
        }
        Integration::Singular { component, .. } => {
            let diagnostic = match state(component) {
                Some(v) => stuck(&explainer, program, v, 0.0, time),
                None => explainer.plain("the iteration matrix is singular", time),
            };
            Failure::numerics(time, diagnostic)
        }
        Integration::TooManySteps { steps, .. } => {
            let message = format!("at time {time} s the limit of {steps} steps is exhausted");
            let diagnostic = Diagnostic::error("MO0910", Span::NONE, message)
                .help("loosen the tolerance, or look for what oscillates at this time");
            Failure::numerics(time, diagnostic)
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
            let message = format!(
                "at time {t} s the event iteration does not end: {} keep changing",
                names.join(", ")
            );
            let diagnostic = Diagnostic::error("MO0913", span, message)
                .help("break the circle of conditions that trigger each other by `pre`");
            Failure::numerics(t, diagnostic)
        }
    }
}

/// Explains why a run could not be initialized.
pub fn start_failure(machine: &Machine<'_>, why: StartError, t: f64) -> Failure {
    let program = machine.program;
    match why {
        StartError::NotAnInput(v) => Failure::settings(format!(
            "`{}` can not be set for a run: it is not a parameter or start value of the program",
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
                None => explainer.plain("a parameter is not finite", t),
            };
            Failure::numerics(t, diagnostic)
        }
        StartError::Clock(k) => {
            let interval = machine.get(program.events.clocks[k].interval);
            let flag = program.blocks.dae.samples[k].flag;
            let message = format!("the interval of a `sample` is {interval} s, not positive");
            let span = program.blocks.dae.variables[flag].span;
            Failure::numerics(t, Diagnostic::error("MO0914", span, message))
        }
        StartError::Assertion(k) => violated(program, &machine.memory, k, t),
        StartError::Event(u) => event_failure(machine, u, t),
    }
}

/// Code of the warning about an unknown that its equations do not determine.
pub const UNDETERMINED: &str = "MO0918";

/// Warns about an unknown of a linear block whose equations are consistent but do not determine it.
pub fn undetermined(
    machine: &Machine<'_>,
    torn_block: usize,
    unknown: usize,
    time: f64,
) -> Diagnostic {
    let program = machine.program;
    let explainer = Explainer::new(program, &machine.memory);
    let text = |v: &str| format!("at time {time} s nothing determines `{v}`");
    let diagnostic = torn_failure(&explainer, program, torn_block, unknown, UNDETERMINED, &text)
        .note("its equations do not contradict each other: the solution nearest to the last one was taken")
        .help("check what ties it down: a ground, a fixed place or a reference may be missing");
    Diagnostic { severity: Severity::Warning, ..diagnostic }
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
    let text = |v: &str| format!("at time {time} s the iteration finds no solution for `{v}`");
    let mut diagnostic = torn_failure(explainer, program, torn_block, unknown, "MO0904", &text);
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
    diagnostic.help(
        "check that there is a solution at all; if so, give `start` and `nominal` values near it",
    )
}

fn stuck(explainer: &Explainer<'_>, program: &Program, v: VarId, h: f64, time: f64) -> Diagnostic {
    let name = &program.blocks.dae.variables[v].name;
    let message = format!(
        "at time {time} s the step became too small ({h:e} s); `{name}` can not be followed"
    );
    of_state(explainer, program, v, "MO0909", message)
        .help("look for a jump, a pole, or a law with infinite slope; loosen the tolerance")
}

fn unbounded(explainer: &Explainer<'_>, program: &Program, v: VarId, time: f64) -> Diagnostic {
    let name = &program.blocks.dae.variables[v].name;
    let message =
        format!("at time {time} s the derivative of `{name}` is not finite, or its slope is not");
    of_state(explainer, program, v, "MO0902", message)
        .help("look for a pole, or a law with infinite slope there, such as a root of zero")
}

/// Explains a failure at a state by its declaration and the equation of its derivative.
fn of_state(
    explainer: &Explainer<'_>,
    program: &Program,
    v: VarId,
    code: &'static str,
    message: String,
) -> Diagnostic {
    let variable = &program.blocks.dae.variables[v];
    let derivative = program.blocks.states.iter().find(|s| s.variable == v).map(|s| s.derivative);
    let mut diagnostic = Diagnostic::error(code, variable.span, message).label(format!(
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
    code: &'static str,
    text: &dyn Fn(&str) -> String,
) -> Diagnostic {
    let s = &program.routines.torn_blocks[torn_block];
    let v = s.unknowns[unknown.min(s.unknowns.len().saturating_sub(1))];
    let torn = block(program, s.place).and_then(|b| torn_of(b, program, torn_block));
    let mut diagnostic = match torn.and_then(|t| t.residuals.get(unknown)) {
        Some(r) => Diagnostic::error(code, explainer.span(r.source), text(program.name(v)))
            .label(explainer.equation(r.source)),
        None => Diagnostic::error(code, Span::NONE, text(program.name(v))),
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
