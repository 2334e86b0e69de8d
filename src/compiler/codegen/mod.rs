//! From the sorted system to a program of flat tapes.
//!
//! In: [`Blocks`]. Out: an immutable [`Program`] that any number of runs share, or diagnostics
//! about unsupported constructs. `runtime` executes programs.
//!
//! Sources: A. Griewank, A. Walther, *Evaluating Derivatives* (2nd ed. 2008) for the Jacobian;
//! Modelica specification 3.6, section 8.6 for the event sequence.
pub mod algebraic;
pub mod block;
mod derivative_function;
pub mod emit;
pub mod error;
mod forcing;
mod function;
pub mod jacobian;
pub mod layout;
mod lazy_branches;
pub mod nominal;
pub mod print;
pub mod recording;
pub mod relation;
mod relation_start;
pub mod rows;
pub mod sequence;
pub mod sink;
pub mod state_selection;
pub mod string_ops;

#[cfg(test)]
mod tests;

use crate::base::diag::Problems;
use crate::base::index::Id;
use crate::ir::blocks::{Block, Blocks, State};
use crate::ir::expr::VarId;
use crate::ir::program::{AlgebraicUnknown, Program, SystemForm, Tapes};
use emit::Emitter;

/// Compiles the sorted system to ordinary differential equations.
///
/// Errors are diagnostics of codes `MO0801` and following.
pub fn compile(blocks: Blocks) -> Result<Program, Problems> {
    compile_as(blocks, SystemForm::Ode)
}

/// Compiles the sorted system to a program of this form.
///
/// Errors are diagnostics of codes `MO0801` and following.
pub fn compile_as(blocks: Blocks, form: SystemForm) -> Result<Program, Problems> {
    compile_for(blocks, form, &[])
}

/// Compiles the sorted system to a program of this form, with code for runs that are differentiated by the parameters
/// `by` ([`Program::forcing`]).
///
/// Errors are diagnostics of codes `MO0801` and following.
pub fn compile_for(blocks: Blocks, form: SystemForm, by: &[VarId]) -> Result<Program, Problems> {
    let Blocks {
        dae,
        states,
        dummies,
        state_sets,
        initial,
        initial_by_states,
        event,
        continuous,
        assumed_starts,
        undetermined,
    } = blocks;
    let mut order = SortedBlocks {
        states,
        algebraics: Vec::new(),
        initial,
        initial_by_states,
        event,
        continuous,
    };
    let mut emitter = Emitter::new(dae);
    if form == SystemForm::Dae {
        order.algebraics = algebraic::find(&mut emitter, &order);
    }
    layout::allocate(&mut emitter, &order);
    sequence::parameters(&mut emitter, &order);
    let at_start = sequence::initial(&mut emitter, &order);
    let by_states = sequence::initial_by_states(&mut emitter, &order);
    emitter.initialized.clear();
    let mut begin: Vec<u32> = at_start.begin.iter().chain(&by_states.begin).copied().collect();
    begin.sort_unstable();
    begin.dedup();
    let relation_starts = relation_start::compile(&mut emitter, &begin);
    let at_events = sequence::event(&mut emitter, &order);
    let decided = sequence::decided(&mut emitter, &order, &at_events.lagged);
    let between = sequence::continuous(&mut emitter, &order, by);
    for k in 0..emitter.layout.delays.len() {
        let v = emitter.layout.delays[k].variable;
        let level = emitter.levels.get(v.idx()).copied().flatten();
        emitter.layout.delays[k].moves = level.is_none_or(|level| level > emit::DISCRETE);
    }
    let (state_selection, set_slots) = state_selection::compile(&mut emitter, &state_sets);
    function::compile_called(&mut emitter);
    if emitter.problems.has_errors() {
        return Err(emitter.problems);
    }
    let literals = emitter.literal_slots();
    let Emitter { dae, image, layout, layers, routines, mut events, bounds, .. } = emitter;
    events.relation_starts = relation_starts;
    events.lagged_initial = at_start.lagged;
    events.lagged_by_states = by_states.lagged;
    events.lagged_event = at_events.lagged;
    let parameters = layers.into_iter().next().map(|l| l.code).unwrap_or_default();
    let SortedBlocks { states, algebraics, initial, initial_by_states, event, continuous } = order;
    let mut program = Program {
        rows: None,
        recorded: recording::all(&dae),
        constants: recording::constants(&dae),
        blocks: Blocks {
            dae,
            states,
            dummies,
            state_sets,
            initial,
            initial_by_states,
            event,
            continuous,
            assumed_starts,
            undetermined,
        },
        image,
        literals,
        layout,
        tapes: Tapes {
            parameters,
            initial: at_start.tape,
            initial_by_states: by_states.tape,
            event: at_events.tape,
            decided,
            discrete: between.discrete,
            rhs: between.rhs,
            roots: between.roots,
            outputs: between.outputs,
            jacobian: between.jacobian,
            state_selection,
        },
        algebraics,
        jacobian_entries: between.jacobian_entries,
        forcing: between.forcing,
        state_sets: set_slots,
        routines,
        events,
        bounds,
        continuation: None,
        foreign: None,
    };
    program.number_tapes();
    Ok(program)
}

/// The sorted blocks without the system itself, which the emitter owns and extends.
pub struct SortedBlocks {
    /// See [`Blocks::states`].
    pub states: Vec<State>,
    /// Algebraic unknowns that are integrated in addition to the states.
    pub algebraics: Vec<AlgebraicUnknown>,
    /// See [`Blocks::initial`].
    pub initial: Vec<Block>,
    /// See [`Blocks::initial_by_states`].
    pub initial_by_states: Vec<Block>,
    /// See [`Blocks::event`].
    pub event: Vec<Block>,
    /// See [`Blocks::continuous`].
    pub continuous: Vec<Block>,
}

impl SortedBlocks {
    /// The components of the integrator: states, then algebraic unknowns.
    pub fn components(&self) -> Vec<VarId> {
        let states = self.states.iter().map(|s| s.variable);
        states.chain(self.algebraics.iter().map(|a| a.variable)).collect()
    }
}
