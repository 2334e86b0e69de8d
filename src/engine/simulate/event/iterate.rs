//! Event iteration: solves the discrete equations at an instant (Modelica specification 3.6,
//! appendix B), and the initial equations (section 8.6).
//!
//! In: a machine with the left limits in its memory. Out: the right limits, and the actions of the
//! event ([`EventEffects`]).

use crate::ir::expr::VarId;
use crate::ir::flat::AssertionLevel;
use crate::ir::program::{Program, Slot, Tape};
use crate::numeric::cycle_detection::CycleDetector;
use crate::runtime::machine::{Fault, Machine};

use super::relation_search::{may_have_solution, solve_relations};
use super::relation_start;
use super::time_events::Clocks;
use crate::simulate::failure::assertion::message_text;

/// Maximum number of passes in which relations and mixed systems of equations settle.
pub const ITERATION_LIMIT: u32 = 100;
/// Passes of an event iteration that may be needed besides: each discrete variable may wait for `pre` of another one, so
/// that a chain takes one pass for each of its variables.
const MOST_CHAINED_PASSES: u32 = 2_000;

/// Maximum number of event iterations at one instant.
fn most_passes(program: &Program) -> u32 {
    ITERATION_LIMIT + (program.layout.pre.len() as u32).min(MOST_CHAINED_PASSES)
}

/// Effects of an event iteration.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct EventEffects {
    /// A discrete variable, a relation or a state changed.
    pub changed: bool,
    /// Position of an active `terminate`.
    pub terminate: Option<usize>,
    /// Position of a failed assertion in a when-clause.
    pub failed: Option<usize>,
    /// Something other than a relation changed.
    pub acted: bool,
    /// A state got another value.
    pub reinitialized: bool,
}

impl EventEffects {
    /// Combines the effects with those of a later iteration at the same instant.
    pub fn before(self, later: EventEffects) -> EventEffects {
        EventEffects {
            changed: self.changed | later.changed,
            terminate: self.terminate.or(later.terminate),
            failed: self.failed.or(later.failed),
            acted: self.acted | later.acted,
            reinitialized: self.reinitialized | later.reinitialized,
        }
    }
}

/// Why an event iteration failed.
#[derive(Clone, PartialEq, Debug)]
pub enum EventError {
    /// A tape failed.
    Fault(Fault),
    /// These variables and relations keep changing.
    NotConverged(Vec<VarId>, Vec<u32>),
}

impl From<Fault> for EventError {
    fn from(fault: Fault) -> Self {
        EventError::Fault(fault)
    }
}

/// Sets `pre(v) := v` for all variables.
pub fn update_pre(machine: &mut Machine<'_>) {
    for k in 0..machine.program.layout.pre.len() {
        let (_, slot, pre) = machine.program.layout.pre[k];
        machine.copy(pre, slot);
    }
}

/// Sets `pre(v) := v` for all variables that are not `fixed`.
fn update_free_pre(machine: &mut Machine<'_>) {
    for k in 0..machine.program.layout.pre.len() {
        let (v, slot, pre) = machine.program.layout.pre[k];
        if machine.program.blocks.dae.variables[v].fixed != Some(true) {
            machine.copy(pre, slot);
        }
    }
}

/// Strategies for finding a fixed point of the event equations, in the order in which they are
/// tried.
///
/// `Direct` solves relations and equations together with `pre` held. If that does not converge,
/// `GaussSeidel` updates `pre` after each pass: this takes friction from sticking to sliding across
/// a maximum that it need not reach again (M. Otter, H. Elmqvist and S. E. Mattsson, "Hybrid
/// modeling in Modelica based on the synchronous data flow principle", CACSD 1999, section 5).
/// Finally, `Enumerate` tries all combinations of relations with `pre` held.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Strategy {
    Direct,
    GaussSeidel,
    Enumerate,
}

/// The result of the first strategy that succeeds. If none does, the error of the first one.
fn try_strategies<'p, T>(
    machine: &mut Machine<'p>,
    exhaustive: bool,
    attempt: impl Fn(&mut Machine<'p>, Strategy) -> Result<T, EventError>,
) -> Result<T, EventError> {
    let others = if exhaustive {
        &[Strategy::GaussSeidel, Strategy::Enumerate][..]
    } else {
        &[Strategy::GaussSeidel]
    };
    let before = machine.snapshot();
    let mut outcome = attempt(machine, Strategy::Direct);
    if outcome.as_ref().is_err_and(may_have_solution) && machine.tangents.is_none() {
        let saved = machine.save_fault();
        for &strategy in others {
            machine.restore_from(&before);
            let found = attempt(machine, strategy);
            if found.is_ok() {
                outcome = found;
                break;
            }
        }
        match outcome {
            Ok(_) => machine.discard_fault(saved),
            Err(_) => machine.restore_fault(saved),
        }
    }
    machine.recycle(before);
    outcome
}

/// Maximum number of passes from the start values that may fail before other strategies are tried.
const MAX_FAILED_PASSES: u32 = 4;

/// Solves the initial sequence. Relations that it reads before it can evaluate them begin with their values at the start
/// values of their operands; if that leads nowhere, all begin with false.
pub fn solve_initial(machine: &mut Machine<'_>) -> Result<(), EventError> {
    let is_any_true = relation_start::evaluate(machine);
    let before = machine.snapshot();
    let mut outcome = solve_initial_from(machine, true, initial_direct);
    if let Err(failed) = &outcome
        && is_any_true
    {
        // All combinations of relations were tried already, if that was promising.
        let exhaustive = !may_have_solution(failed);
        let saved = machine.save_fault();
        machine.restore_from(&before);
        relation_start::clear(machine);
        let found = solve_initial_from(machine, exhaustive, |machine| {
            let (tape, lagged) = initial_sequence(machine);
            solve_relations(machine, tape, lagged, false)
        });
        if found.is_ok() {
            machine.discard_fault(saved);
            outcome = found;
        } else {
            machine.restore_fault(saved);
        }
    }
    machine.recycle(before);
    // Events are about other relations.
    machine.relation_solutions.clear();
    outcome
}

/// Solves the initial sequence from the values of relations in the memory, at first by `direct`. The Gauss-Seidel strategy
/// sets `pre(v) = v` unless `v` is fixed (Modelica specification 3.6, section 8.6).
fn solve_initial_from<'p>(
    machine: &mut Machine<'p>,
    exhaustive: bool,
    direct: impl Fn(&mut Machine<'p>) -> Result<(), EventError>,
) -> Result<(), EventError> {
    try_strategies(machine, exhaustive, |machine, strategy| match strategy {
        Strategy::Direct => direct(machine),
        Strategy::GaussSeidel => initial_gauss_seidel(machine),
        Strategy::Enumerate => {
            let (tape, lagged) = initial_sequence(machine);
            solve_relations(machine, tape, lagged, true)
        }
    })
}

/// Solves relations and equations together. A pass that fails has computed the operands of some relations: if that gives
/// others than it began with, the next pass begins with them.
fn initial_direct(machine: &mut Machine<'_>) -> Result<(), EventError> {
    let (tape, lagged) = initial_sequence(machine);
    machine.failed_block = None;
    let mut outcome = solve_relations(machine, tape, lagged, false);
    for _ in 0..MAX_FAILED_PASSES {
        if !matches!(outcome, Err(EventError::Fault(_))) || !relation_start::evaluate_again(machine)
        {
            break;
        }
        outcome = solve_relations(machine, tape, lagged, false);
    }
    outcome
}

/// The initial sequence in use, and the relations that it reads before it can evaluate them.
fn initial_sequence<'p>(machine: &Machine<'p>) -> (&'p Tape, &'p [u32]) {
    let program: &'p Program = machine.program;
    match machine.starts_by_states {
        true => (&program.tapes.initial_by_states, &program.events.lagged_by_states),
        false => (&program.tapes.initial, &program.events.lagged_initial),
    }
}

fn initial_gauss_seidel(machine: &mut Machine<'_>) -> Result<(), EventError> {
    let (tape, lagged) = initial_sequence(machine);
    for _ in 0..ITERATION_LIMIT {
        relaxed_pass(machine, tape, lagged)?;
        update_free_pre(machine);
        if !machine.still_changing {
            // Confirm the fixed point by a direct solution.
            return solve_relations(machine, tape, lagged, false);
        }
    }
    Err(EventError::NotConverged(Vec::new(), Vec::new()))
}

/// Executes a tape once in relaxed mode; sets `still_changing` if mixed blocks or relations
/// changed.
fn relaxed_pass<'p>(
    machine: &mut Machine<'p>,
    tape: &'p Tape,
    lagged: &[u32],
) -> Result<(), EventError> {
    let first = machine.program.layout.relations;
    let previous: Vec<f64> = lagged.iter().map(|k| machine.get(first + k)).collect();
    (machine.relaxed, machine.still_changing, machine.is_unsolved) = (true, false, false);
    let outcome = machine.run(tape);
    machine.relaxed = false;
    outcome?;
    let changed = lagged.iter().zip(&previous).any(|(k, h)| machine.get(first + k) != *h);
    if machine.is_unsolved && !changed {
        return Err(EventError::NotConverged(Vec::new(), Vec::new()));
    }
    machine.still_changing |= changed;
    Ok(())
}

/// The event iteration at the current time and states, starting from the left limits in the memory.
/// The caller raises the flags of clocks. All combinations of relations are tried only if
/// `exhaustive`: an iteration at a slightly later instant may not need them.
pub fn iterate(
    machine: &mut Machine<'_>,
    clocks: &Clocks,
    exhaustive: bool,
) -> Result<EventEffects, EventError> {
    // Discard the messages of failed attempts.
    let messages = machine.assertion_messages.len();
    let outcome = try_strategies(machine, exhaustive, |machine, strategy| {
        machine.assertion_messages.truncate(messages);
        iterate_with(machine, clocks, strategy)
    });
    if outcome.is_err() {
        machine.assertion_messages.truncate(messages);
    }
    outcome
}

fn iterate_with(
    machine: &mut Machine<'_>,
    clocks: &Clocks,
    strategy: Strategy,
) -> Result<EventEffects, EventError> {
    let program = machine.program;
    let first = program.layout.relations;
    let count = program.events.relation_triggers.len() as Slot;
    let before: Vec<f64> = (0..count).map(|k| machine.get(first + k)).collect();
    let mut effects = EventEffects::default();
    let mut ticking = program.events.clocks.iter().any(|c| machine.get(c.flag) != 0.0);
    effects.changed |= ticking;
    update_pre(machine);
    if ticking {
        // The flags are discrete variables themselves: their edge starts at false.
        for clock in &program.events.clocks {
            for &(_, slot, pre) in &program.layout.pre {
                if slot == clock.flag {
                    machine.set(pre, 0.0);
                }
            }
        }
    }
    let mut changing = Vec::new();
    let mut cycle = CycleDetector::default();
    for pass in 0..most_passes(program) {
        // What takes that long is a chain, which never repeats, or does not end.
        if pass >= ITERATION_LIMIT {
            let values = program.layout.pre.iter().map(|(_, _, pre)| machine.get(*pre));
            if cycle.repeats(&values.collect::<Vec<_>>()) {
                break;
            }
        }
        let mut repeat = false;
        if pass > 0 {
            evaluate_decided(machine);
        }
        if strategy == Strategy::GaussSeidel {
            relaxed_pass(machine, &program.tapes.event, &program.events.lagged_event)?;
            repeat = machine.still_changing;
        } else {
            solve_relations(
                machine,
                &program.tapes.event,
                &program.events.lagged_event,
                strategy == Strategy::Enumerate,
            )?;
        }
        collect_actions(machine, &mut effects);
        let reinitialized = apply_reinits(machine);
        effects.reinitialized |= reinitialized;
        repeat |= reinitialized;
        changing.clear();
        for &(v, slot, pre) in &program.layout.pre {
            let discrete =
                program.blocks.dae.variables[v].kind == crate::ir::dae::VariableKind::Discrete;
            if discrete && machine.get(slot).to_bits() != machine.get(pre).to_bits() {
                changing.push(v);
            }
        }
        repeat |= !changing.is_empty();
        effects.changed |= repeat;
        effects.acted |= repeat || ticking;
        if ticking {
            clocks.lower(machine);
            repeat = true;
            ticking = false;
        }
        update_pre(machine);
        if !repeat && strategy == Strategy::GaussSeidel {
            // Confirm the fixed point by a direct solution.
            solve_relations(machine, &program.tapes.event, &program.events.lagged_event, false)?;
        }
        if !repeat || effects.failed.is_some() {
            let now = (0..count).map(|k| machine.get(first + k));
            effects.changed |= now.zip(&before).any(|(a, b)| a != *b);
            if machine.undetermined.take().is_some() {
                // Whether that is so at the solution, too, which another solution of singular equations must not replace.
                let solution = machine.memory.to_vec();
                machine.run(&program.tapes.event)?;
                machine.restore_from(&solution);
            }
            machine.run(&program.tapes.discrete)?;
            return Ok(effects);
        }
    }
    Err(EventError::NotConverged(changing, Vec::new()))
}

/// Evaluates the lagged relations for the present values of the discrete variables, now that `pre` has changed. Relations
/// and discrete variables may have several solutions together, one of which lies where the relations have the signs of the
/// motion before: a body with dry friction whose speed comes to zero would slide on although it may stick. The next value
/// of the discrete variables follows from their last one, as in M. Otter, H. Elmqvist and S. E. Mattsson, Hybrid Modeling
/// in Modelica Based on the Synchronous Data Flow Principle (CACSD 1999). Where the equations have no solution
/// then, the relations stay.
fn evaluate_decided(machine: &mut Machine<'_>) {
    let program = machine.program;
    if program.tapes.decided.is_empty() {
        return;
    }
    let before = machine.snapshot();
    if machine.run(&program.tapes.decided).is_err() {
        machine.fault = None;
        machine.restore_from(&before);
    }
    machine.recycle(before);
}

/// Collects violated assertions of when-clauses and terminations that are active.
pub fn collect_actions(machine: &mut Machine<'_>, effects: &mut EventEffects) {
    let program = machine.program;
    for (k, a) in program.events.asserts.iter().enumerate() {
        let active = a.at_events && machine.get(a.active) != 0.0;
        if !active || machine.get(a.condition) != 0.0 {
            continue;
        }
        let assert = &program.blocks.dae.asserts[k].assert;
        if assert.level != AssertionLevel::Error {
            let text = message_text(program, &machine.memory, assert.message);
            machine.assertion_messages.push((k, text));
        } else if effects.failed.is_none() {
            effects.failed = Some(k);
        }
    }
    for (k, slot) in program.events.terminates.iter().enumerate() {
        if machine.get(*slot) != 0.0 && effects.terminate.is_none() {
            effects.terminate = Some(k);
        }
    }
}

/// Applies active `reinit`s; true if there are any.
fn apply_reinits(machine: &mut Machine<'_>) -> bool {
    let mut any = false;
    for r in &machine.program.events.reinits {
        if machine.get(r.active) != 0.0 {
            machine.copy(r.state, r.value);
            any = true;
        }
    }
    any
}
