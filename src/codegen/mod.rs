//! From the sorted system to a program of flat tapes.
//!
//! What comes in: [`Blocks`]. What goes out: an immutable [`Program`] that any number of runs share,
//! or diagnostics about what can not be compiled. [`interp`] runs a program; it stays the oracle of
//! every faster way to run one.
//!
//! Sources: A. Griewank, A. Walther, *Evaluating Derivatives* (2nd ed. 2008) for the Jacobian;
//! Modelica specification 3.6, section 8.6 for the event sequence.
pub mod algebraic;
pub mod block;
pub mod emit;
pub mod error;
mod function;
pub mod jacobian;
pub mod layout;
mod lazy_branches;
pub mod nominal;
pub mod print;
pub mod recording;
pub mod relation;
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
use crate::ir::program::{Algebraic, Form, Program};
use emit::Emitter;

/// Compiles the sorted system to ordinary differential equations.
///
/// Errors are diagnostics of codes `MO0801` and following.
pub fn compile(blocks: Blocks) -> Result<Program, Problems> {
    compile_as(blocks, Form::Reduced)
}

/// Compiles the sorted system to a program of this form.
///
/// Errors are diagnostics of codes `MO0801` and following.
pub fn compile_as(blocks: Blocks, form: Form) -> Result<Program, Problems> {
    let Blocks { dae, states, dummies, state_sets, initial, event, continuous, assumed_starts } =
        blocks;
    let mut order = Order { states, algebraics: Vec::new(), initial, event, continuous };
    let mut emitter = Emitter::new(dae);
    if form == Form::Implicit {
        order.algebraics = algebraic::find(&mut emitter, &order);
    }
    layout::allocate(&mut emitter, &order);
    function::compile_all(&mut emitter);
    sequence::parameters(&mut emitter, &order);
    let at_start = sequence::initial(&mut emitter, &order);
    let at_events = sequence::event(&mut emitter, &order);
    let between = sequence::continuous(&mut emitter, &order);
    for k in 0..emitter.layout.delays.len() {
        let v = emitter.layout.delays[k].variable;
        let level = emitter.levels.get(v.idx()).copied().flatten();
        emitter.layout.delays[k].moves = level.is_none_or(|level| level > emit::HELD);
    }
    let (selection, set_cells) = state_selection::compile(&mut emitter, &state_sets);
    if emitter.problems.has_errors() {
        return Err(emitter.problems);
    }
    let literals = emitter.literal_cells();
    let Emitter { dae, image, layout, layers, solvers, implicits, loops, calls, .. } = emitter;
    let parameters = layers.into_iter().next().map(|l| l.code).unwrap_or_default();
    let Order { states, algebraics, initial, event, continuous } = order;
    let mut program = Program {
        recorded: recording::all(&dae),
        constants: recording::constants(&dae),
        blocks: Blocks {
            dae,
            states,
            dummies,
            state_sets,
            initial,
            event,
            continuous,
            assumed_starts,
        },
        image,
        literals,
        layout,
        parameters,
        initial: at_start.tape,
        late_initial: at_start.late,
        event: at_events.tape,
        late_event: at_events.late,
        held: between.held,
        rhs: between.rhs,
        roots: between.roots,
        rest: between.rest,
        jacobian: between.jacobian,
        algebraics,
        jacobian_entries: between.jacobian_entries,
        selection,
        state_sets: set_cells,
        solvers,
        implicits,
        loops,
        calls,
        functions: emitter.functions,
        watches: emitter.watches,
        clocks: emitter.clocks,
        reinits: emitter.reinits,
        asserts: emitter.asserts,
        bounds: emitter.bounds,
        terminates: emitter.terminates,
        reads_terminal: emitter.reads_terminal,
        continuation: None,
    };
    program.number_tapes();
    Ok(program)
}

/// The sorted blocks, apart from the system itself, which the emitter owns and extends.
pub struct Order {
    /// See [`Blocks::states`].
    pub states: Vec<State>,
    /// What is integrated besides the states.
    pub algebraics: Vec<Algebraic>,
    /// See [`Blocks::initial`].
    pub initial: Vec<Block>,
    /// See [`Blocks::event`].
    pub event: Vec<Block>,
    /// See [`Blocks::continuous`].
    pub continuous: Vec<Block>,
}

impl Order {
    /// What is integrated: states, then algebraic unknowns.
    pub fn components(&self) -> Vec<VarId> {
        let states = self.states.iter().map(|s| s.variable);
        states.chain(self.algebraics.iter().map(|a| a.variable)).collect()
    }
}
