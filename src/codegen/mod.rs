//! From the sorted system to a program of flat tapes.
//!
//! What comes in: [`Blocks`]. What goes out: an immutable [`Program`] that any number of runs share,
//! or diagnostics about what can not be compiled. [`interp`] runs a program; it stays the oracle of
//! every faster way to run one.
//!
//! Sources: A. Griewank, A. Walther, *Evaluating Derivatives* (2nd ed. 2008) for the Jacobian;
//! Modelica specification 3.6, section 8.6 for the event sequence.
pub mod emit;
pub mod error;
pub mod function;
pub mod interp;
pub mod jacobian;
pub mod layout;
pub mod sequence;
pub mod solve;

use crate::base::diag::Problems;
use crate::ir::blocks::Blocks;
use crate::ir::program::Program;

/// Compiles the sorted system.
///
/// Errors are diagnostics of codes `MO0801` and following.
pub fn compile(blocks: Blocks) -> Result<Program, Problems> {
    let mut emitter = emit::Emitter::new(blocks.dae.clone());
    layout::allocate(&mut emitter, &blocks);
    function::compile_all(&mut emitter);
    sequence::parameters(&mut emitter, &blocks);
    let initial = sequence::initial(&mut emitter, &blocks);
    let event = sequence::event(&mut emitter, &blocks);
    let continuous = sequence::continuous(&mut emitter, &blocks);
    if emitter.problems.has_errors() {
        return Err(emitter.problems);
    }
    let emit::Emitter { dae, image, layout, layers, solvers, implicits, loops, calls, .. } =
        emitter;
    let parameters = layers.into_iter().next().map(|l| l.code).unwrap_or_default();
    Ok(Program {
        blocks: Blocks { dae, ..blocks },
        image,
        layout,
        parameters,
        initial: initial.tape,
        late_initial: initial.late,
        event: event.tape,
        late_event: event.late,
        held: continuous.held,
        rhs: continuous.rhs,
        roots: continuous.roots,
        rest: continuous.rest,
        jacobian: continuous.jacobian,
        jacobian_entries: continuous.jacobian_entries,
        solvers,
        implicits,
        loops,
        calls,
        functions: emitter.functions,
        watches: emitter.watches,
        clocks: emitter.clocks,
        reinits: emitter.reinits,
        asserts: emitter.asserts,
        terminates: emitter.terminates,
    })
}
