//! Options of the integrator: tolerances from nominal values, and limits of the step size.

use crate::base::index::Id;
use crate::integrate::options::Options;
use crate::ir::expr::{Node, Unary};
use crate::ir::program::{Program, RelationTrigger};

use super::settings::Settings;
use super::state_selection::LIMIT;
use super::system::HybridSystem;

/// Maximum step, in sampling intervals of the recordings that drive the model.
const MAX_STEP_INTERVALS: f64 = 4.0;
/// Tolerances are not sharpened beyond this.
const MIN_RTOL: f64 = 1e-12;
/// Minimum number of steps of a run with an oscillating source and state-dependent relations.
const MIN_OSCILLATION_STEPS: f64 = 50.0;

/// Options of the integrator for a model at its start.
pub fn options(system: &HybridSystem<'_>, settings: &Settings) -> Options {
    let program = system.machine.program;
    let nominals = program.layout.nominals.iter().map(|slot| {
        let size = system.machine.get(*slot).abs();
        if size > 0.0 && size.is_finite() { size } else { 1.0 }
    });
    let mut nominals: Vec<f64> = nominals.collect();
    nominals.resize(program.order().max(1), 1.0);
    // Dependent candidates must meet the tolerance too, although they react more strongly.
    let reaction = if program.state_sets.is_empty() { 1.0 } else { LIMIT * LIMIT };
    let tolerance = (settings.tolerance / reaction).max(MIN_RTOL.min(settings.tolerance));
    let mut options = Options::with_nominals(tolerance, &nominals);
    options.max_steps = settings.most_steps;
    // Shorter features of the signals could be stepped over.
    let machine = &system.machine;
    options.max_step = MAX_STEP_INTERVALS * machine.input_signals.spacing();
    options.max_step = options.max_step.min(machine.delays.shortest_delay(&machine.memory));
    if program.events.relation_triggers.contains(&RelationTrigger::State) && oscillates(program) {
        // While states are constant nothing else limits the step, and a pulse of the source could
        // be stepped over.
        options.max_step =
            options.max_step.min((settings.stop - settings.start) / MIN_OSCILLATION_STEPS);
    }
    if program.order() == 0 && settings.stop > settings.start {
        // A constant state does not limit the step, but events must not be stepped over.
        options.max_step = options.max_step.min(settings.spacing.unwrap_or(settings.interval));
    }
    options
}

/// True if a sine or cosine of time occurs in the model.
fn oscillates(program: &Program) -> bool {
    let graph = &program.blocks.dae.graph;
    let mut of_time: Vec<bool> = Vec::with_capacity(graph.len());
    for e in graph.ids() {
        let node = graph.node(e);
        let mut moves = node == Node::Time;
        // Operands have lower numbers.
        graph.for_each_operand(e, |a| moves |= of_time[a.idx()]);
        if moves && matches!(node, Node::Unary(Unary::Sin | Unary::Cos, _)) {
            return true;
        }
        of_time.push(moves);
    }
    false
}
