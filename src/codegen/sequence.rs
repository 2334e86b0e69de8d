//! The sequences of blocks as tapes.

use crate::base::index::{FastMap, Id};
use crate::ir::blocks::Block;
use crate::ir::dae::{Dae, Kind, Trigger};
use crate::ir::expr::{ExprId, Node, Type, Unary, VarId};
use crate::ir::program::{
    AssertCells, BlockPlace, Clock, Entry, Op, ReinitCells, Sequence, Slot, Tape,
};
use crate::ir::program::{Bounds, DelayCells, ReaderCells, TransportCells};

use super::block::{self, compile_block, compile_mixed};
use super::emit::{Emitter, HELD, MOVING, PARAMETER};
use super::layout::{block_unknowns, block_values, resting_value};
use super::relation::{evaluate_relation, relations_in, watch_relations};
use super::{Order, algebraic, error, jacobian, nominal};

/// The initial or the event sequence.
pub struct Discrete {
    /// Its tape.
    pub tape: Tape,
    /// Relations that are read before they can be evaluated: after a change of one of them the tape
    /// must run again.
    pub late: Vec<u32>,
}

/// The tapes between events.
pub struct Continuous {
    /// After events.
    pub held: Tape,
    /// Derivatives.
    pub rhs: Tape,
    /// Relations and assertions.
    pub roots: Tape,
    /// All else.
    pub rest: Tape,
    /// Derivatives of the derivatives.
    pub jacobian: Tape,
    /// Entries of the Jacobian.
    pub jacobian_entries: Vec<Entry>,
}

/// Parameters, start values, typical sizes and clocks: the bottom layer.
pub fn parameters(e: &mut Emitter, blocks: &Order) {
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
    for (v, variable) in e.dae.variables.enumerate() {
        if variable.kind == Kind::Parameter && e.levels[v.idx()].is_none() {
            e.problems.push(error::undetermined(&variable.name, variable.span));
        }
    }
    let starts = std::mem::take(&mut e.layout.starts);
    for (v, input, start) in starts {
        e.span = e.dae.variables[v].span;
        let value = e.dae.variables[v].start;
        let default = match value {
            // Starts that depend on what initialisation determines are evaluated there.
            Some(value) if e.level_of(&[value], |_| false) > PARAMETER => {
                e.starts.remove(&v);
                continue;
            }
            Some(value) => e.emit(value).0,
            None => e.literal(resting_value(e.dae.variables[v].ty)),
        };
        e.push(PARAMETER, Op::Input, start, default, input);
        e.layout.starts.push((v, input, start));
    }
    for (v, time) in e.dae.delays.clone() {
        let (source, delay) = (e.slot(v), e.emit(time).0);
        e.layout.delays.push(DelayCells { variable: v, source, delay, moves: true });
    }
    for line in e.dae.transports.clone() {
        let initial = line.initial.iter().map(|(p, v)| (e.emit(*p).0, e.emit(*v).0)).collect();
        let readers = line.readers.iter().map(|reader| ReaderCells {
            place: e.slot(reader.place),
            from: e.recorded(reader.from, 0),
            to: e.recorded(reader.to, 0),
        });
        let readers = readers.collect();
        let ends = line.ends.map(|v| e.slot(v));
        let entering = line.entering.map(|v| v.map(|v| e.slot(v)));
        e.layout.transports.push(TransportCells { ends, entering, initial, readers });
    }
    e.layout.nominals = nominal::of_components(e, &blocks.components());
    bounds(e);
    for k in 0..e.dae.samples.len() {
        let sample = e.dae.samples[k].clone();
        let start = clock_value(e, sample.start);
        let interval = clock_value(e, sample.interval);
        e.clocks.push(Clock { start, interval, flag: e.slot(sample.flag) });
    }
}

/// The cells of what has bounds.
fn bounds(e: &mut Emitter) {
    let mut stands_for_itself = vec![true; e.dae.variables.len()];
    for (v, value) in &e.dae.eliminated {
        let is_alias = match e.dae.graph.node(*value) {
            Node::Unary(Unary::Neg, a) => matches!(e.dae.graph.node(a), Node::Var(_)),
            node => matches!(node, Node::Var(_)),
        };
        stands_for_itself[v.idx()] = !is_alias;
    }
    for v in e.dae.variables.ids() {
        let variable = &e.dae.variables[v];
        let is_bounded = variable.min.is_some() || variable.max.is_some();
        if is_bounded && stands_for_itself[v.idx()] && variable.ty != Type::String {
            let (min, max) = block::bounds(e, v);
            let bounds =
                Bounds { variable: v, value: e.slot(v), min, max, nominal: block::nominal(e, v) };
            e.bounds.push(bounds);
        }
    }
}

/// The initial sequence.
pub fn initial(e: &mut Emitter, blocks: &Order) -> Discrete {
    begin(e, false);
    e.moving = HELD;
    e.push_layer();
    e.floor = HELD;
    let late = with_relations(e, &blocks.initial, Sequence::Initial);
    for (cell, value) in std::mem::take(&mut e.late_clocks) {
        e.emit_to(cell, value);
    }
    Discrete { tape: e.pop_discard(), late }
}

/// The event sequence, then what acts on its result.
pub fn event(e: &mut Emitter, blocks: &Order) -> Discrete {
    begin(e, true);
    e.moving = HELD;
    for state in &blocks.states {
        e.levels[state.variable.idx()] = Some(HELD);
    }
    e.push_layer();
    e.floor = HELD;
    let late = with_relations(e, &blocks.event, Sequence::Event);
    for k in 0..e.dae.reinits.len() {
        let reinit = e.dae.reinits[k].clone();
        e.span = reinit.origin.span;
        let (active, value) = (e.cell(0.0), e.cell(0.0));
        e.emit_to(active, reinit.active);
        e.emit_to(value, reinit.value);
        e.reinits.push(ReinitCells { active, state: e.slot(reinit.state), value });
    }
    for k in 0..e.dae.asserts.len() {
        let cells = AssertCells {
            active: e.cell(1.0),
            condition: e.cell(1.0),
            at_events: e.dae.asserts[k].active.is_some(),
        };
        e.asserts.push(cells);
        assertion(e, k);
    }
    for k in 0..e.dae.terminates.len() {
        let active = e.dae.terminates[k].active;
        let cell = e.cell(0.0);
        e.emit_to(cell, active);
        e.terminates.push(cell);
    }
    Discrete { tape: e.pop_discard(), late }
}

/// The continuous sequence, split by what needs it.
pub fn continuous(e: &mut Emitter, blocks: &Order) -> Continuous {
    begin(e, true);
    e.moving = MOVING;
    for v in blocks.components() {
        e.levels[v.idx()] = Some(MOVING);
    }
    let derivatives: Vec<ExprId> = blocks.states.iter().map(|s| e.read(s.derivative)).collect();
    let need = Needs::new(e, &blocks.continuous);
    let for_rhs = need.below(e, &derivatives);
    let watched = watched_expressions(&e.dae);
    let for_roots = need.below(e, &watched);

    e.push_layer();
    e.floor = e.push_layer();
    let mut solvers: FastMap<usize, u32> = FastMap::default();
    let mut needed = Vec::new();
    for (i, block) in blocks.continuous.iter().enumerate().filter(|(i, _)| for_rhs[*i]) {
        needed.push(i);
        if let Block::Torn(torn) = block
            && let Some(k) = algebraic::position(&blocks.algebraics, torn)
        {
            algebraic::compile(e, torn, blocks.states.len() + k);
            continue;
        }
        solvers.insert(i, e.solvers.len() as u32);
        compile_block(e, block, BlockPlace { sequence: Sequence::Continuous, index: i });
    }
    for state in &blocks.states {
        if let Some(&value) = e.replaced.get(&state.derivative) {
            let slot = e.slot(state.derivative);
            e.emit_to(slot, value);
        }
    }

    e.floor = e.push_layer();
    for (i, block) in blocks.continuous.iter().enumerate() {
        if for_roots[i] && !for_rhs[i] {
            compile_block(e, block, BlockPlace { sequence: Sequence::Continuous, index: i });
        }
    }
    watch_relations(e);
    for k in 0..e.dae.asserts.len() {
        if !e.asserts[k].at_events {
            assertion(e, k);
        }
    }

    e.floor = e.push_layer();
    for (i, block) in blocks.continuous.iter().enumerate() {
        if !for_roots[i] && !for_rhs[i] {
            compile_block(e, block, BlockPlace { sequence: Sequence::Continuous, index: i });
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
    let rest = e.pop_discard();
    let roots = e.pop_discard();

    e.floor = e.push_layer();
    let jacobian_entries = jacobian::of_system(e, blocks, &needed, &solvers);
    let jacobian = e.pop_discard();
    let rhs = e.pop_discard();
    let held = e.pop_discard();
    Continuous { held, rhs, roots, rest, jacobian, jacobian_entries }
}

/// Forgets what the last sequence computed. `initialised`: parameters with `fixed = false` are known.
pub fn begin(e: &mut Emitter, initialised: bool) {
    for (v, variable) in e.dae.variables.enumerate() {
        e.levels[v.idx()] = match variable.kind {
            Kind::Parameter => Some(PARAMETER),
            Kind::InitialParameter if initialised => Some(HELD),
            Kind::Discrete | Kind::Input => Some(HELD),
            _ => None,
        };
    }
}

/// The cell of a time of a clock. Clocks begin after the initialisation, so that it may determine them.
fn clock_value(e: &mut Emitter, value: ExprId) -> Slot {
    let initial = |v: VarId| {
        matches!(
            e.dae.variables[v].kind,
            Kind::Parameter | Kind::InitialParameter | Kind::Eliminated
        )
    };
    let known = e.dae.graph.variables(value).into_iter().all(initial);
    if known && e.level_of(&[value], |_| false) > PARAMETER {
        let cell = e.cell(f64::INFINITY);
        e.late_clocks.push((cell, value));
        return cell;
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
    let cells = e.asserts[k];
    if let Some(active) = guarded.active {
        e.emit_to(cells.active, active);
    }
    e.emit_to(cells.condition, guarded.assert.condition);
}

/// Operands of searched relations, and conditions that are checked along the way.
fn watched_expressions(dae: &Dae) -> Vec<ExprId> {
    let relations = dae.relations.iter().filter(|r| r.trigger == Trigger::State);
    let mut all: Vec<ExprId> = relations.flat_map(|r| [r.lhs, r.rhs]).collect();
    all.extend(dae.asserts.iter().filter(|a| a.active.is_none()).map(|a| a.assert.condition));
    all
}

/// Which blocks determine what.
pub struct Needs {
    maker: FastMap<VarId, usize>,
    reads: Vec<Vec<VarId>>,
}

impl Needs {
    /// Of a sequence.
    pub fn new(e: &Emitter, blocks: &[Block]) -> Self {
        let mut maker = FastMap::default();
        let mut reads = Vec::new();
        for (i, block) in blocks.iter().enumerate() {
            let (mut unknowns, mut values) = (Vec::new(), Vec::new());
            block_unknowns(block, &mut unknowns);
            block_values(block, &mut values);
            maker.extend(unknowns.into_iter().map(|v| (v, i)));
            reads.push(e.reads(&values));
        }
        Needs { maker, reads }
    }

    /// The blocks that `roots` depend on.
    pub fn below(&self, e: &Emitter, roots: &[ExprId]) -> Vec<bool> {
        let mut needed = vec![false; self.reads.len()];
        let mut pending = e.reads(roots);
        while let Some(v) = pending.pop() {
            if let Some(&i) = self.maker.get(&v)
                && !needed[i]
            {
                needed[i] = true;
                pending.extend(&self.reads[i]);
            }
        }
        needed
    }

    /// One past the last block that `roots` depend on directly; 0 if none.
    fn ready(&self, e: &Emitter, roots: &[ExprId]) -> usize {
        e.reads(roots).iter().filter_map(|v| self.maker.get(v)).map(|i| i + 1).max().unwrap_or(0)
    }
}

/// Compiles a sequence in which relations are evaluated afresh, each as soon as its operands are
/// known. Returns those that are read earlier.
fn with_relations(e: &mut Emitter, blocks: &[Block], sequence: Sequence) -> Vec<u32> {
    let need = Needs::new(e, blocks);
    let count = e.dae.relations.len();
    let mut ready = Vec::with_capacity(count);
    for k in 0..count {
        let r = e.dae.relations[k].clone();
        let mut at = need.ready(e, &[r.lhs, r.rhs]);
        for inner in relations_in(e, &[r.lhs, r.rhs]) {
            at = at.max(ready.get(inner as usize).copied().unwrap_or(blocks.len()));
        }
        ready.push(at);
    }
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|&k| (ready[k], k));
    let mut order = order.into_iter().peekable();
    let mut late = vec![false; count];
    for (i, block) in blocks.iter().enumerate() {
        while let Some(k) = order.next_if(|&k| ready[k] <= i) {
            evaluate_relation(e, k, sequence);
        }
        let mut values = Vec::new();
        block_values(block, &mut values);
        let mut inside = Vec::new();
        for k in relations_in(e, &values) {
            let mixed = matches!(block, Block::Mixed(_)) && ready[k as usize] == i + 1;
            if mixed {
                inside.push(k as usize);
            } else if ready[k as usize] > i {
                late[k as usize] = true;
            }
        }
        let place = BlockPlace { sequence, index: i };
        match block {
            Block::Mixed(parts) => compile_mixed(e, parts, &inside, place),
            _ => compile_block(e, block, place),
        }
    }
    for k in order {
        evaluate_relation(e, k, sequence);
    }
    (0..count as u32).filter(|k| late[*k as usize]).collect()
}
