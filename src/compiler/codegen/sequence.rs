//! Compiles the sequences of blocks to tapes.

use crate::base::index::{FastMap, Id, IdMap};
use crate::ir::blocks::Block;
use crate::ir::dae::{Dae, Delay, Trigger, VariableKind};
use crate::ir::expr::{ExprId, Node, Type, Unary, VarId};
use crate::ir::program::{
    AssertSlots, BlockPosition, Clock, Entry, Forcing, Op, ReinitSlots, Sequence, Slot, Tape,
};
use crate::ir::program::{Bounds, DelaySlots, ReaderSlots, TransportSlots};

use super::block::{self, compile_block, compile_mixed};
use super::emit::{CONTINUOUS, DISCRETE, Emitter, PARAMETER};
use super::layout::default_start;
use super::relation::{emit_indicators, evaluate_relation, relations_in};
use super::{SortedBlocks, algebraic, error, forcing, jacobian, nominal};

/// The initial or the event sequence.
#[derive(Default)]
pub struct SequenceTape {
    /// Its tape.
    pub tape: Tape,
    /// Relations that are read before they can be evaluated: if one of them changes, the tape must
    /// run again.
    pub lagged: Vec<u32>,
    /// Relations that need a value before the tape runs: those, and those that mixed blocks iterate.
    pub begin: Vec<u32>,
}

/// The tapes between events.
pub struct Continuous {
    /// Expressions that change at events only.
    pub discrete: Tape,
    /// Derivatives.
    pub rhs: Tape,
    /// Zero-crossing indicators and assertions.
    pub roots: Tape,
    /// All other variables.
    pub outputs: Tape,
    /// The Jacobian of the derivatives.
    pub jacobian: Tape,
    /// Entries of the Jacobian.
    pub jacobian_entries: Vec<Entry>,
    /// Derivatives by parameters.
    pub forcing: Option<Forcing>,
}

/// Compiles the bottom layer: parameters, start values, nominal values and clocks.
pub fn parameters(e: &mut Emitter, blocks: &SortedBlocks) {
    let inputs: FastMap<VarId, Slot> = e.layout.parameter_inputs.iter().copied().collect();
    for k in 0..e.dae.parameters.len() {
        let (v, value) = e.dae.parameters[k];
        e.span = e.dae.variables[v].span;
        e.levels[v.idx()] = Some(PARAMETER);
        if e.dae.variables[v].ty == Type::String {
            let (dst, (from, _)) = (e.slot(v), e.emit(value));
            e.push(PARAMETER, Op::Copy, dst, from, from);
        } else {
            let (default, _) = parameter_value(e, value);
            let dst = e.slot(v);
            e.push(PARAMETER, Op::Input, dst, default, inputs[&v]);
        }
    }
    e.layout.parameters.1 = e.image.len() as Slot;
    for (v, variable) in e.dae.variables.enumerate() {
        if variable.kind == VariableKind::Parameter && e.levels[v.idx()].is_none() {
            e.problems.push(error::undetermined(&variable.name, variable.span));
        }
    }
    let starts = std::mem::take(&mut e.layout.starts);
    for (v, input, start) in starts {
        e.span = e.dae.variables[v].span;
        let value = e.dae.variables[v].start;
        let default = match value {
            // Start values that depend on results of initialization are evaluated there.
            Some(value) if e.level_of(&[value], |_| false) > PARAMETER => {
                e.start_slots.remove(&v);
                continue;
            }
            Some(value) => e.emit(value).0,
            None => e.literal(default_start(e.dae.variables[v].ty)),
        };
        e.push(PARAMETER, Op::Input, start, default, input);
        e.layout.starts.push((v, input, start));
    }
    for Delay { variable, time, input } in e.dae.delays.clone() {
        // The signal of an input can be shifted only by a time that is known before the run.
        let input = input.filter(|_| e.level_of(&[time], |_| false) == PARAMETER);
        let (source, delay) = (e.slot(variable), initialized_value(e, time, 0.0));
        e.layout.delays.push(DelaySlots { variable, source, delay, input, moves: true });
    }
    for line in e.dae.transports.clone() {
        // Lines are filled after initialization, which may determine what fills them.
        let mut filled = |value| initialized_value(e, value, 0.0);
        let initial = line.initial.iter().map(|(p, v)| (filled(*p), filled(*v))).collect();
        let readers = line.readers.iter().map(|reader| ReaderSlots {
            place: e.slot(reader.place),
            from: e.recorded(reader.from, 0),
            to: e.recorded(reader.to, 0),
        });
        let readers = readers.collect();
        let ends = line.ends.map(|v| e.slot(v));
        let entering = line.entering.map(|v| v.map(|v| e.slot(v)));
        e.layout.transports.push(TransportSlots { ends, entering, initial, readers });
    }
    e.layout.nominals = nominal::of_components(e, &blocks.components());
    bounds(e);
    for k in 0..e.dae.samples.len() {
        let sample = e.dae.samples[k].clone();
        let start = clock_value(e, sample.start);
        let interval = clock_value(e, sample.interval);
        e.events.clocks.push(Clock { start, interval, flag: e.slot(sample.flag) });
    }
}

/// Compiles the bounds of variables.
fn bounds(e: &mut Emitter) {
    let mut is_representative = vec![true; e.dae.variables.len()];
    for (v, value) in &e.dae.eliminated {
        let is_alias = match e.dae.graph.node(*value) {
            Node::Unary(Unary::Neg, a) => matches!(e.dae.graph.node(a), Node::Var(_)),
            node => matches!(node, Node::Var(_)),
        };
        is_representative[v.idx()] = !is_alias;
    }
    for v in e.dae.variables.ids() {
        let variable = &e.dae.variables[v];
        let is_bounded = variable.min.is_some() || variable.max.is_some();
        if is_bounded && is_representative[v.idx()] && variable.ty != Type::String {
            let (min, max) = block::bounds(e, v);
            let bounds =
                Bounds { variable: v, value: e.slot(v), min, max, nominal: block::nominal(e, v) };
            e.bounds.push(bounds);
        }
    }
}

/// Compiles the initial sequence.
pub fn initial(e: &mut Emitter, blocks: &SortedBlocks) -> SequenceTape {
    reset_levels(e, false);
    e.continuous_level = DISCRETE;
    e.push_layer();
    e.floor = DISCRETE;
    let (lagged, begin) = compile_with_relations(e, &blocks.initial, Sequence::Initial);
    for (slot, value) in e.initialized.clone() {
        e.emit_to(slot, value);
    }
    SequenceTape { tape: e.pop_discard(), lagged, begin }
}

/// Compiles the initial sequence whose loops are torn at states; empty if there is none.
pub fn initial_by_states(e: &mut Emitter, blocks: &SortedBlocks) -> SequenceTape {
    if blocks.initial_by_states.is_empty() {
        return SequenceTape::default();
    }
    reset_levels(e, false);
    e.continuous_level = DISCRETE;
    e.push_layer();
    e.floor = DISCRETE;
    let sequence = Sequence::InitialByStates;
    let (lagged, begin) = compile_with_relations(e, &blocks.initial_by_states, sequence);
    for (slot, value) in e.initialized.clone() {
        e.emit_to(slot, value);
    }
    SequenceTape { tape: e.pop_discard(), lagged, begin }
}

/// Begins a layer in which states are known, as they are at events.
fn begin_event(e: &mut Emitter, blocks: &SortedBlocks) {
    reset_levels(e, true);
    e.continuous_level = DISCRETE;
    for state in &blocks.states {
        e.levels[state.variable.idx()] = Some(DISCRETE);
    }
    e.push_layer();
    e.floor = DISCRETE;
}

/// Compiles the event sequence, followed by the actions that depend on its result.
pub fn event(e: &mut Emitter, blocks: &SortedBlocks) -> SequenceTape {
    begin_event(e, blocks);
    let (lagged, begin) = compile_with_relations(e, &blocks.event, Sequence::Event);
    for k in 0..e.dae.reinits.len() {
        let reinit = e.dae.reinits[k].clone();
        e.span = reinit.origin.span;
        let (active, value) = (e.new_slot(0.0), e.new_slot(0.0));
        e.emit_to(active, reinit.active);
        e.emit_to(value, reinit.value);
        e.events.reinits.push(ReinitSlots { active, state: e.slot(reinit.state), value });
    }
    for k in 0..e.dae.asserts.len() {
        let slots = AssertSlots {
            active: e.new_slot(1.0),
            condition: e.new_slot(1.0),
            at_events: e.dae.asserts[k].active.is_some(),
        };
        e.events.asserts.push(slots);
        assertion(e, k);
    }
    for k in 0..e.dae.terminates.len() {
        let active = e.dae.terminates[k].active;
        let slot = e.new_slot(0.0);
        e.emit_to(slot, active);
        e.events.terminates.push(slot);
    }
    SequenceTape { tape: e.pop_discard(), lagged, begin }
}

/// Compiles the relations that the event sequence reads before it can evaluate them, and what they depend on, but for the
/// discrete variables that follow from them directly; empty if none of these has a choice ([`block::decisions`]).
pub fn decided(e: &mut Emitter, blocks: &SortedBlocks, lagged: &[u32]) -> Tape {
    let relations: Vec<usize> = lagged.iter().map(|k| *k as usize).collect();
    let decides = block::decisions(e, &blocks.event, &relations);
    if !decides.contains(&true) {
        return Tape::default();
    }
    begin_event(e, blocks);
    let operands: Vec<ExprId> =
        relations.iter().flat_map(|k| [e.dae.relations[*k].lhs, e.dae.relations[*k].rhs]).collect();
    let needed = Dependencies::new(e, &blocks.event).blocks_for(e, &operands);
    for (i, block) in blocks.event.iter().enumerate() {
        if needed[i] && !decides[i] {
            compile_block(e, block, BlockPosition { sequence: Sequence::Event, index: i });
        }
    }
    for k in relations {
        evaluate_relation(e, k, Sequence::Event);
    }
    e.pop_discard()
}

/// Compiles the continuous sequence, split into derivatives, indicators and outputs, with what runs need that are
/// differentiated by the parameters `by`.
pub fn continuous(e: &mut Emitter, blocks: &SortedBlocks, by: &[VarId]) -> Continuous {
    reset_levels(e, true);
    e.continuous_level = CONTINUOUS;
    for v in blocks.components() {
        e.levels[v.idx()] = Some(CONTINUOUS);
    }
    let derivatives: Vec<ExprId> = blocks.states.iter().map(|s| e.read(s.derivative)).collect();
    let need = Dependencies::new(e, &blocks.continuous);
    let for_rhs = need.blocks_for(e, &derivatives);
    let monitored = monitored_expressions(&e.dae);
    let for_roots = need.blocks_for(e, &monitored);

    e.push_layer();
    e.floor = e.push_layer();
    let mut torn_blocks: FastMap<usize, u32> = FastMap::default();
    let mut needed = Vec::new();
    for (i, block) in blocks.continuous.iter().enumerate().filter(|(i, _)| for_rhs[*i]) {
        needed.push(i);
        if let Block::Torn(torn) = block
            && let Some(k) = algebraic::position(&blocks.algebraics, torn)
        {
            algebraic::compile(e, torn, blocks.states.len() + k);
            continue;
        }
        torn_blocks.insert(i, e.routines.torn_blocks.len() as u32);
        compile_block(e, block, BlockPosition { sequence: Sequence::Continuous, index: i });
    }
    for state in &blocks.states {
        if let Some(&value) = e.substitutions.get(state.derivative) {
            let slot = e.slot(state.derivative);
            e.emit_to(slot, value);
        }
    }

    e.floor = e.push_layer();
    for (i, block) in blocks.continuous.iter().enumerate() {
        if for_roots[i] && !for_rhs[i] {
            compile_block(e, block, BlockPosition { sequence: Sequence::Continuous, index: i });
        }
    }
    emit_indicators(e);
    for k in 0..e.dae.asserts.len() {
        if !e.events.asserts[k].at_events {
            assertion(e, k);
        }
    }

    e.floor = e.push_layer();
    for (i, block) in blocks.continuous.iter().enumerate() {
        if !for_roots[i] && !for_rhs[i] {
            compile_block(e, block, BlockPosition { sequence: Sequence::Continuous, index: i });
        }
    }
    for k in 0..e.dae.eliminated.len() {
        let (v, value) = e.dae.eliminated[k];
        e.span = e.dae.variables[v].span;
        if e.dae.variables[v].ty != Type::String {
            let slot = e.slot(v);
            e.emit_to(slot, value);
        }
    }
    let outputs = e.pop_discard();
    let roots = e.pop_discard();

    e.floor = e.push_layer();
    let components = blocks.components();
    let jacobian_entries = jacobian::of_system(e, blocks, &needed, &torn_blocks, &components);
    let forcing = forcing::of_system(e, blocks, &needed, &torn_blocks, by);
    let jacobian = e.pop_discard();
    let rhs = e.pop_discard();
    let discrete = e.pop_discard();
    Continuous { discrete, rhs, roots, outputs, jacobian, jacobian_entries, forcing }
}

/// Resets the levels of all variables for a new sequence. `initialised`: parameters with
/// `fixed = false` are known.
pub fn reset_levels(e: &mut Emitter, initialised: bool) {
    for (v, variable) in e.dae.variables.enumerate() {
        e.levels[v.idx()] = match variable.kind {
            VariableKind::Parameter => Some(PARAMETER),
            VariableKind::InitialParameter if initialised => Some(DISCRETE),
            VariableKind::Discrete | VariableKind::Input => Some(DISCRETE),
            _ => None,
        };
    }
}

/// The slot of a time of a clock. Clocks start after initialization, which may determine them.
fn clock_value(e: &mut Emitter, value: ExprId) -> Slot {
    initialized_value(e, value, f64::INFINITY)
}

/// The slot of a value that initialization may determine, and what it holds until then.
fn initialized_value(e: &mut Emitter, value: ExprId, before: f64) -> Slot {
    let initial = |v: VarId| {
        matches!(
            e.dae.variables[v].kind,
            VariableKind::Parameter | VariableKind::InitialParameter | VariableKind::Eliminated
        )
    };
    let known = e.dae.graph.variables(value).into_iter().all(initial);
    if known && e.level_of(&[value], |_| false) > PARAMETER {
        let slot = e.new_slot(before);
        e.initialized.push((slot, value));
        return slot;
    }
    parameter_value(e, value).0
}

fn parameter_value(e: &mut Emitter, value: ExprId) -> (Slot, usize) {
    if e.level_of(&[value], |_| false) > PARAMETER {
        e.problems.push(error::not_supported(e.span, "a parameter that depends on a variable"));
        return (e.literal(0.0), PARAMETER);
    }
    e.emit(value)
}

fn assertion(e: &mut Emitter, k: usize) {
    let guarded = e.dae.asserts[k].clone();
    e.span = guarded.origin.span;
    let slots = e.events.asserts[k];
    if let Some(active) = guarded.active {
        e.emit_to(slots.active, active);
    }
    e.emit_to(slots.condition, guarded.assert.condition);
}

/// Operands of state-dependent relations, and conditions of assertions outside of when-clauses.
fn monitored_expressions(dae: &Dae) -> Vec<ExprId> {
    let relations = dae.relations.iter().filter(|r| r.trigger == Trigger::State);
    let mut all: Vec<ExprId> = relations.flat_map(|r| [r.lhs, r.rhs]).collect();
    all.extend(dae.asserts.iter().filter(|a| a.active.is_none()).map(|a| a.assert.condition));
    all
}

/// Dependencies between the blocks of a sequence.
pub struct Dependencies {
    producer: IdMap<VarId, u32>,
    reads: Vec<Vec<VarId>>,
}

impl Dependencies {
    /// Analyses a sequence.
    pub fn new(e: &Emitter, blocks: &[Block]) -> Self {
        let mut producer = IdMap::default();
        let mut reads = Vec::new();
        for (i, block) in blocks.iter().enumerate() {
            let (unknowns, values) = (block.unknowns(), block.expressions());
            unknowns.into_iter().for_each(|v| producer.insert(v, i as u32));
            reads.push(e.reads(&values));
        }
        Dependencies { producer, reads }
    }

    /// The blocks that `roots` depend on.
    pub fn blocks_for(&self, e: &Emitter, roots: &[ExprId]) -> Vec<bool> {
        let mut needed = vec![false; self.reads.len()];
        let mut pending = e.reads(roots);
        while let Some(v) = pending.pop() {
            let Some(&i) = self.producer.get(v) else { continue };
            if !std::mem::replace(&mut needed[i as usize], true) {
                pending.extend(&self.reads[i as usize]);
            }
        }
        needed
    }

    /// Earliest position at which `roots` can be evaluated: one past the last block that they read
    /// directly; 0 if none.
    fn earliest_position(&self, e: &Emitter, roots: &[ExprId]) -> usize {
        let reads = e.reads(roots);
        let producers = reads.iter().filter_map(|v| self.producer.get(*v));
        producers.map(|i| *i as usize + 1).max().unwrap_or(0)
    }
}

/// Compiles a sequence that evaluates relations, each as soon as its operands are known. Returns
/// the relations that are read before that, and with them those that mixed blocks iterate.
fn compile_with_relations(
    e: &mut Emitter,
    blocks: &[Block],
    sequence: Sequence,
) -> (Vec<u32>, Vec<u32>) {
    let need = Dependencies::new(e, blocks);
    let count = e.dae.relations.len();
    let mut position = Vec::with_capacity(count);
    for k in 0..count {
        let r = e.dae.relations[k].clone();
        let mut at = need.earliest_position(e, &[r.lhs, r.rhs]);
        for inner in relations_in(e, &[r.lhs, r.rhs]) {
            at = at.max(position.get(inner as usize).copied().unwrap_or(blocks.len()));
        }
        position.push(at);
    }
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|&k| (position[k], k));
    let mut order = order.into_iter().peekable();
    let mut lagged = vec![false; count];
    let mut begin = vec![false; count];
    for (i, block) in blocks.iter().enumerate() {
        while let Some(k) = order.next_if(|&k| position[k] <= i) {
            evaluate_relation(e, k, sequence);
        }
        let values = block.expressions();
        let mut inside = Vec::new();
        for k in relations_in(e, &values) {
            let mixed = matches!(block, Block::Mixed(_)) && position[k as usize] == i + 1;
            if mixed {
                inside.push(k as usize);
                begin[k as usize] = true;
            } else if position[k as usize] > i {
                lagged[k as usize] = true;
                begin[k as usize] = true;
            }
        }
        let place = BlockPosition { sequence, index: i };
        match block {
            Block::Mixed(parts) => compile_mixed(e, parts, &inside, place),
            _ => compile_block(e, block, place),
        }
    }
    for k in order {
        evaluate_relation(e, k, sequence);
    }
    let those = |chosen: &[bool]| (0..count as u32).filter(|k| chosen[*k as usize]).collect();
    (those(&lagged), those(&begin))
}
