//! The sequences of blocks as tapes.

use crate::base::index::{FastMap, FastSet, Id};
use crate::base::source::Span;
use crate::ir::blocks::{Assignment, Block, Source, Torn};
use crate::ir::dae::{Dae, Kind, Trigger};
use crate::ir::expr::{Binary, ExprId, Node, Type, VarId};
use crate::ir::program::{
    AssertCells, BlockPlace, Clock, Entry, Loop, Op, ReinitCells, Sequence, Slot, Solver, Tape,
    Watch, Watched,
};
use crate::symbolic::gradient::{Leaf, gradient};

use super::emit::{Emitter, HELD, MOVING, PARAMETER};
use super::layout::{block_unknowns, block_values, resting_value};
use super::{Order, error, jacobian};

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
        // Texts are for messages only; nothing reads them while running.
        if e.dae.variables[v].ty != Type::String {
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
    e.layout.nominals = blocks.states.iter().map(|s| nominal(e, s.variable)).collect();
    for k in 0..e.dae.samples.len() {
        let sample = e.dae.samples[k].clone();
        let (start, _) = parameter_value(e, sample.start);
        let (interval, _) = parameter_value(e, sample.interval);
        e.clocks.push(Clock { start, interval, flag: e.slot(sample.flag) });
    }
}

/// The initial sequence.
pub fn initial(e: &mut Emitter, blocks: &Order) -> Discrete {
    begin(e, false);
    e.moving = HELD;
    e.push_layer();
    e.floor = HELD;
    let late = with_relations(e, &blocks.initial, Sequence::Initial);
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
    for state in &blocks.states {
        e.levels[state.variable.idx()] = Some(MOVING);
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
fn begin(e: &mut Emitter, initialised: bool) {
    for (v, variable) in e.dae.variables.enumerate() {
        e.levels[v.idx()] = match variable.kind {
            Kind::Parameter => Some(PARAMETER),
            Kind::InitialParameter if initialised => Some(HELD),
            Kind::Discrete | Kind::Input => Some(HELD),
            _ => None,
        };
    }
}

fn parameter_value(e: &mut Emitter, value: ExprId) -> (Slot, usize) {
    let (slot, level) = e.emit(value);
    if level > PARAMETER {
        e.problems.push(error::not_supported(e.span, "a parameter that depends on a variable"));
    }
    (slot, level)
}

/// The cell of the typical size of a variable; one where it has none.
fn nominal(e: &mut Emitter, v: VarId) -> Slot {
    match e.dae.variables[v].nominal {
        Some(value) if e.level_of(&[value], |_| false) == PARAMETER => e.emit(value).0,
        _ => e.literal(1.0),
    }
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

/// Emits the truth and the distance from switching of searched relations, and instants of others.
fn watch_relations(e: &mut Emitter) {
    for k in 0..e.dae.relations.len() {
        let relation = e.dae.relations[k].clone();
        e.span = relation.origin.span;
        let watch = match relation.trigger {
            Trigger::Discrete => Watch::Discrete,
            Trigger::Time { instant } => Watch::Time(e.emit(instant).0),
            Trigger::State => {
                let truth = e.dae.graph.binary(relation.op, relation.lhs, relation.rhs);
                e.emit_to(e.layout.fresh + k as Slot, truth);
                let gap = e.dae.graph.sub(relation.lhs, relation.rhs);
                e.emit_to(e.layout.gaps + k as Slot, gap);
                Watch::State
            }
        };
        e.watches.push(watch);
    }
}

/// Which blocks determine what.
struct Needs {
    maker: FastMap<VarId, usize>,
    reads: Vec<Vec<VarId>>,
}

impl Needs {
    fn new(e: &Emitter, blocks: &[Block]) -> Self {
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
    fn below(&self, e: &Emitter, roots: &[ExprId]) -> Vec<bool> {
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

/// The relations that `roots` read, ascending.
fn relations_in(e: &Emitter, roots: &[ExprId]) -> Vec<u32> {
    let nodes = e.dae.graph.postorder(roots.iter().copied());
    let mut found: Vec<u32> = nodes
        .into_iter()
        .filter_map(|n| match e.dae.graph.node(n) {
            Node::Relation(k) => Some(k),
            _ => None,
        })
        .collect();
    found.sort_unstable();
    found
}

fn evaluate_relation(e: &mut Emitter, k: usize, sequence: Sequence) {
    let relation = e.dae.relations[k].clone();
    e.span = relation.origin.span;
    let literal = e.dae.graph.binary(relation.op, relation.lhs, relation.rhs);
    let truth = match relation.trigger {
        Trigger::Time { instant } if sequence == Sequence::Event => {
            right_limit(e, literal, relation.op, relation.lhs, relation.rhs, instant)
        }
        _ => literal,
    };
    e.emit_to(e.layout.relations + k as Slot, truth);
}

/// A comparison with time as it holds just after this instant, whatever the rounding: `time > t1`
/// is true at the event at `t1` already, otherwise it would never switch.
fn right_limit(
    e: &mut Emitter,
    literal: ExprId,
    op: Binary,
    lhs: ExprId,
    rhs: ExprId,
    instant: ExprId,
) -> ExprId {
    let g = &mut e.dae.graph;
    let gap = g.sub(lhs, rhs);
    let slope = gradient(g, gap, |leaf| leaf == Leaf::Time);
    let Some(&(_, slope)) = slope.first() else { return literal };
    let (zero, time) = (g.real(0.0), g.time());
    let passed = g.binary(Binary::GreaterEqual, time, instant);
    let not_passed = g.not(passed);
    let rising = g.binary(Binary::Greater, slope, zero);
    let (after_rise, after_fall) = if matches!(op, Binary::Greater | Binary::GreaterEqual) {
        (passed, not_passed)
    } else {
        (not_passed, passed)
    };
    g.if_then_else(rising, after_rise, after_fall)
}

fn compile_block(e: &mut Emitter, block: &Block, place: BlockPlace) {
    match block {
        Block::Assign(a) => compile_assignment(e, a),
        Block::Torn(t) => compile_torn(e, t, place),
        Block::Mixed(parts) => compile_mixed(e, parts, &[], place),
    }
}

fn compile_assignment(e: &mut Emitter, a: &Assignment) {
    e.span = source_span(&e.dae, a.source);
    if let Source::Start(v) = a.source
        && let Some(&start) = e.starts.get(&v)
    {
        let dst = e.slot(a.variable);
        e.push(HELD, Op::Copy, dst, start, start);
        e.levels[a.variable.idx()] = Some(HELD);
        return;
    }
    e.assign(a.variable, a.value);
}

fn compile_torn(e: &mut Emitter, torn: &Torn, place: BlockPlace) {
    let torn = &with_start_cells(e, torn);
    let block = Block::Torn(torn.clone());
    let (mut own, mut values) = (Vec::new(), Vec::new());
    block_unknowns(&block, &mut own);
    block_values(&block, &mut values);
    let own_set: FastSet<VarId> = own.iter().copied().collect();
    let inputs = e.level_of(&values, |v| own_set.contains(&v));
    let target = e.home(inputs.max(HELD));

    let inside = e.push_layer();
    for &v in &torn.unknowns {
        e.levels[v.idx()] = Some(inside);
    }
    for a in &torn.explicit {
        compile_assignment(e, a);
    }
    let mut residuals = Vec::new();
    for r in &torn.residuals {
        e.span = source_span(&e.dae, r.source);
        residuals.push(e.emit(r.value).0);
    }
    let entries = jacobian::of_torn(e, torn);
    e.push_layer();
    let mut jacobian = Vec::new();
    for (row, column, value) in entries {
        jacobian.push(Entry { row, column, slot: e.emit(value).0 });
    }
    let jacobian_tape = e.pop_discard();
    let residual_tape = e.pop_merge(target);
    for &v in &own {
        e.levels[v.idx()] = e.levels[v.idx()].map(|l| if l == inside { target } else { l });
    }
    let nominals = torn.unknowns.iter().map(|v| nominal(e, *v)).collect();
    let solver = Solver {
        slots: torn.unknowns.iter().map(|v| e.slot(*v)).collect(),
        unknowns: torn.unknowns.clone(),
        residual_tape,
        residuals,
        jacobian_tape,
        jacobian,
        nominals,
        linear: torn.linear,
        place,
    };
    e.solvers.push(solver);
    e.push(target, Op::Solve, 0, (e.solvers.len() - 1) as Slot, 0);
}

/// Residuals `v - start` read the cell of the start value, which a run may set.
fn with_start_cells(e: &mut Emitter, torn: &Torn) -> Torn {
    let mut torn = torn.clone();
    for r in &mut torn.residuals {
        if let Source::Start(v) = r.source
            && let Some(&cell) = e.starts.get(&v)
        {
            let start = e.auxiliary(Some(PARAMETER));
            e.layout.variables[start.idx()] = cell;
            let (own, start) = (e.read(v), e.dae.graph.var(start, Type::Real));
            r.value = e.dae.graph.sub(own, start);
        }
    }
    torn
}

fn compile_mixed(e: &mut Emitter, parts: &[Block], relations: &[usize], place: BlockPlace) {
    let target = e.home(e.moving.max(HELD));
    let inside = e.push_layer();
    let mut own = Vec::new();
    parts.iter().for_each(|p| block_unknowns(p, &mut own));
    for &v in &own {
        e.levels[v.idx()] = Some(inside);
    }
    for part in parts {
        compile_block(e, part, place);
        // What follows may change what was computed from the variables of the loop.
        e.forget_top();
        let mut assigned = Vec::new();
        block_unknowns(part, &mut assigned);
        for v in assigned {
            e.levels[v.idx()] = Some(inside);
        }
    }
    for &k in relations {
        evaluate_relation(e, k, place.sequence);
    }
    let tape = e.pop_discard();
    let mut watched = Vec::new();
    for &v in &own {
        e.levels[v.idx()] = Some(target);
        if e.dae.variables[v].kind == Kind::Discrete {
            watched.push(Watched::Variable(v, e.slot(v)));
        }
    }
    let first = e.layout.relations;
    watched.extend(relations.iter().map(|&k| Watched::Relation(k as u32, first + k as Slot)));
    e.loops.push(Loop { tape, watched, place });
    e.push(target, Op::Repeat, 0, (e.loops.len() - 1) as Slot, 0);
}

/// Where the equation of a block stands.
pub fn source_span(dae: &Dae, source: Source) -> Span {
    match source {
        Source::Continuous(i) => dae.equations[i].origin.span,
        Source::Discrete(i) => dae.discrete[i].origin.span,
        Source::Initial(i) => dae.initial[i].origin.span,
        Source::Start(v) => dae.variables[v].span,
    }
}
