//! What the integrator is told: tolerances by nominal values, and how long its steps may be.

use crate::base::index::Id;
use crate::integrate::options::Options;
use crate::ir::expr::{Node, Unary};
use crate::ir::program::{Program, RelationTrigger};

use super::settings::Settings;
use super::state_selection::LIMIT;
use super::system::HybridSystem;

/// Longest step in intervals between two values of a recording that drives the model.
const UNSEEN: f64 = 4.0;
/// Tolerances are not sharpened beyond this.
const SHARPEST: f64 = 1e-12;
/// Fewest steps of a run in which a source oscillates and relations are searched.
const LEAST_STEPS: f64 = 50.0;

/// Options of the integrator for a model at its start.
pub fn options(system: &HybridSystem<'_>, settings: &Settings) -> Options {
    let program = system.machine.program;
    let nominals = program.layout.nominals.iter().map(|slot| {
        let size = system.machine.get(*slot).abs();
        if size > 0.0 && size.is_finite() { size } else { 1.0 }
    });
    let mut nominals: Vec<f64> = nominals.collect();
    nominals.resize(program.order().max(1), 1.0);
    // What is not selected meets the tolerance too, though it and its rate react stronger.
    let reaction = if program.state_sets.is_empty() { 1.0 } else { LIMIT * LIMIT };
    let tolerance = (settings.tolerance / reaction).max(SHARPEST.min(settings.tolerance));
    let mut options = Options::with_nominals(tolerance, &nominals);
    options.max_steps = settings.most_steps;
    // What is shorter than a step may not be seen.
    let machine = &system.machine;
    options.max_step = UNSEEN * machine.input_signals.spacing();
    options.max_step = options.max_step.min(machine.delays.shortest_delay(&machine.memory));
    if program.events.relation_triggers.contains(&RelationTrigger::State) && oscillates(program) {
        // Where states rest nothing but this limits the step, and a source may come and go within it.
        options.max_step = options.max_step.min((settings.stop - settings.start) / LEAST_STEPS);
    }
    if program.order() == 0 && settings.stop > settings.start {
        // Nothing limits the error of a resting state, but events must not be stepped over.
        options.max_step = options.max_step.min(settings.spacing.unwrap_or(settings.interval));
    }
    options
}

/// True if a sine or cosine of time stands in the model.
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
