//! Compiles expressions to instructions. Each expression is computed once, at the lowest possible
//! rate.
//!
//! The emitter holds a stack of *layers*, each a tape under construction. Layer 0 runs once per run
//! (parameters), layer 1 after each event, higher layers more often or within a torn block. The
//! level of an expression is the highest level among its leaves. It is emitted to the layer of that
//! level and memoized, so equal expressions are computed once for all layers above.

use crate::base::diag::Problems;
use crate::base::index::{FastMap, FastSet, Id, IdMap};
use crate::base::source::Span;
use crate::ir::dae::{Dae, VariableKind};
use crate::ir::expr::{Binary, ExprId, FunctionId, ListId, Node, Type, Unary, VarId};
use crate::ir::program::{Bounds, CallSite, Events, Instr, Layout, Op, Routines, Slot, Tape};

use super::derivative_function::{self, Derivatives};
use super::error;
use super::sink::{CallKey, expensive_functions, sink_conditions};
use super::string_ops;

/// How often an expression is computed: the index of a layer.
pub type Level = usize;

/// Depends on parameters only.
pub const PARAMETER: Level = 0;
/// Changes at events only.
pub const DISCRETE: Level = 1;
/// Varies continuously.
pub const CONTINUOUS: Level = 2;

/// A tape under construction, and the values it defines.
#[derive(Default)]
pub struct Layer {
    /// Instructions.
    pub code: Tape,
    defined: Vec<ExprId>,
    defined_calls: Vec<CallKey>,
}

/// Where the value of an expression is, and from which layer on.
#[derive(Clone, Copy)]
struct Place {
    slot: Slot,
    level: u16,
}

impl Place {
    fn new(slot: Slot, level: Level) -> Place {
        // A block within a block is a layer: there are never thousands.
        Place { slot, level: level as u16 }
    }
}

/// The state of a compilation.
pub struct Emitter {
    /// The system; its graph grows with derivatives.
    pub dae: Dae,
    /// Initial memory.
    pub image: Vec<f64>,
    /// Memory map.
    pub layout: Layout,
    /// Level of each variable, auxiliary ones included; `None` before it is computed.
    pub levels: Vec<Option<Level>>,
    /// Variables defined by an expression: eliminated ones, and auxiliary names of calls.
    pub substitutions: IdMap<VarId, ExprId>,
    /// Slots of `pre(v)`.
    pub pre_slots: FastMap<VarId, Slot>,
    /// Slot of the start value of a variable.
    pub start_slots: FastMap<VarId, Slot>,
    /// The stack of layers.
    pub layers: Vec<Layer>,
    /// Continuously varying expressions go to this layer or above.
    pub floor: Level,
    /// Level of time, of states and of everything else that varies continuously.
    pub continuous_level: Level,
    /// Blocks, calls and functions compiled so far.
    pub routines: Routines,
    /// Relations, clocks and actions at events compiled so far.
    pub events: Events,
    /// Slots of clocks and delays that the initial tape fills, because initialization determines
    /// them.
    pub initialized: Vec<(Slot, ExprId)>,
    /// See [`crate::ir::program::Program::bounds`].
    pub bounds: Vec<Bounds>,
    /// Errors so far.
    pub problems: Problems,
    /// Source position of the equation being compiled.
    pub span: Span,
    literals: FastMap<u64, Slot>,
    values: IdMap<ExprId, Place>,
    call_results: FastMap<CallKey, (Slot, Level)>,
    /// Conditions under which calls are needed.
    sink_conditions: FastMap<CallKey, ExprId>,
    /// Functions whose calls may be expensive.
    expensive_functions: FastSet<FunctionId>,
    /// Functions that compute the derivatives of others.
    pub derivatives: Derivatives,
}

impl Emitter {
    /// An emitter for a system, before any block is compiled.
    pub fn new(mut dae: Dae) -> Self {
        let derivatives = derivative_function::add(&mut dae);
        let expensive_functions = expensive_functions(&dae, &derivatives);
        let sink_conditions = sink_conditions(&mut dae, &expensive_functions);
        let count = dae.variables.len();
        let substitutions = dae.eliminated.iter().copied().collect();
        Emitter {
            dae,
            image: Vec::new(),
            layout: Layout::default(),
            levels: vec![None; count],
            substitutions,
            pre_slots: FastMap::default(),
            start_slots: FastMap::default(),
            layers: vec![Layer::default()],
            floor: DISCRETE,
            continuous_level: DISCRETE,
            routines: Routines::default(),
            events: Events::default(),
            initialized: Vec::new(),
            bounds: Vec::new(),
            problems: Problems::new(),
            span: Span::NONE,
            literals: FastMap::default(),
            values: IdMap::default(),
            call_results: FastMap::default(),
            sink_conditions,
            expensive_functions,
            derivatives,
        }
    }

    /// A new slot with this initial value.
    pub fn new_slot(&mut self, value: f64) -> Slot {
        self.image.push(value);
        (self.image.len() - 1) as Slot
    }

    /// The first of `n` new consecutive slots.
    pub fn new_slots(&mut self, n: usize, value: f64) -> Slot {
        let first = self.image.len() as Slot;
        self.image.resize(self.image.len() + n, value);
        first
    }

    /// The slot of a literal.
    pub fn literal(&mut self, value: f64) -> Slot {
        if let Some(slot) = self.literals.get(&value.to_bits()) {
            return *slot;
        }
        let slot = self.new_slot(value);
        self.literals.insert(value.to_bits(), slot);
        slot
    }

    /// The slots of all literals, ascending.
    pub fn literal_slots(&self) -> Vec<Slot> {
        let mut slots: Vec<Slot> = self.literals.values().copied().collect();
        slots.sort_unstable();
        slots
    }

    /// A new auxiliary variable with its own slot.
    pub fn auxiliary(&mut self, level: Option<Level>) -> VarId {
        let slot = self.new_slot(0.0);
        self.levels.push(level);
        self.layout.variables.push(slot);
        VarId::from_usize(self.levels.len() - 1)
    }

    /// The slot of a variable.
    pub fn slot(&self, v: VarId) -> Slot {
        self.layout.variables[v.idx()]
    }

    /// Opens a layer on top; returns its level.
    pub fn push_layer(&mut self) -> Level {
        self.layers.push(Layer::default());
        self.layers.len() - 1
    }

    /// Closes the top layer; its values can no longer be read.
    pub fn pop_discard(&mut self) -> Tape {
        self.invalidate_top();
        self.layers.pop().map(|l| l.code).unwrap_or_default()
    }

    /// Invalidates the values of the top layer but keeps its code: its variables are about to
    /// change.
    pub fn invalidate_top(&mut self) {
        if let Some(layer) = self.layers.last_mut() {
            for e in layer.defined.drain(..) {
                self.values.remove(e);
            }
            for call in layer.defined_calls.drain(..) {
                self.call_results.remove(&call);
            }
        }
    }

    /// Closes the top layer; its values can be read from layer `target` on.
    pub fn pop_merge(&mut self, target: Level) -> Tape {
        let Some(layer) = self.layers.pop() else { return Tape::default() };
        for e in &layer.defined {
            if let Some(place) = self.values.get_mut(*e) {
                *place = Place::new(place.slot, target);
            }
        }
        for call in &layer.defined_calls {
            if let Some(k) = self.call_results.get_mut(call) {
                k.1 = target;
            }
        }
        self.layers[target].defined.extend(layer.defined);
        self.layers[target].defined_calls.extend(layer.defined_calls);
        layer.code
    }

    /// Appends an instruction to a layer.
    pub fn push(&mut self, level: Level, op: Op, dst: Slot, a: Slot, b: Slot) {
        self.layers[level].code.push(Instr { op, dst, a, b });
    }

    /// The layer for an expression whose leaves have at most this level.
    pub fn layer_for(&self, level: Level) -> Level {
        if level <= DISCRETE { level } else { level.max(self.floor) }
    }

    /// Emits the instructions that compute `root`; returns its slot and level.
    pub fn emit(&mut self, root: ExprId) -> (Slot, Level) {
        if let Some(found) = self.lookup(root) {
            return found;
        }
        let mut stack = vec![(root, false)];
        while let Some((e, ready)) = stack.pop() {
            if self.lookup(e).is_some() {
                continue;
            }
            if ready {
                self.emit_node(e);
                continue;
            }
            stack.push((e, true));
            let first = stack.len();
            match self.dae.graph.node(e) {
                Node::Var(v) => stack.extend(self.substitutions.get(v).map(|r| (*r, false))),
                // The simplified expression only serves initialization by continuation.
                Node::Homotopy(actual, _) => stack.push((actual, false)),
                _ => self.dae.graph.for_each_operand(e, |a| stack.push((a, false))),
            }
            stack[first..].reverse();
        }
        self.operand(root)
    }

    /// Emits `variable := value`; returns the new level of the variable.
    pub fn assign(&mut self, v: VarId, value: ExprId) -> Level {
        let dst = self.slot(v);
        let level = self.emit_to(dst, value).max(DISCRETE);
        self.levels[v.idx()] = Some(level);
        level
    }

    /// Emits `slot := value` to layer 1 or above; returns the level of the value.
    pub fn emit_to(&mut self, dst: Slot, value: ExprId) -> Level {
        let is_new = self.lookup(value).is_none();
        let (slot, level) = self.emit(value);
        let layer = self.layer_for(level.max(DISCRETE));
        // The number of a literal lies in the slot of the literal, which something else computes.
        let own = match self.dae.graph.node(value) {
            Node::Unary(op, _) => op != Unary::Ordinal,
            Node::Binary(..) | Node::If(..) => true,
            _ => false,
        };
        if is_new && own && level == layer && self.retarget(layer, slot, dst) {
            self.values.insert(value, Place::new(dst, level));
        } else {
            self.push(layer, Op::Copy, dst, slot, slot);
        }
        layer
    }

    /// Makes the last instruction write to `to` instead of `from`; a selection has two
    /// instructions.
    fn retarget(&mut self, level: Level, from: Slot, to: Slot) -> bool {
        let code = &mut self.layers[level].code;
        let Some(last) = code.last().copied() else { return false };
        if last.dst != from
            || matches!(last.op, Op::Call | Op::Solve | Op::Iterate | Op::Differentiate)
        {
            return false;
        }
        let parts = if last.op == Op::CopyIf { 2 } else { 1 };
        let first = code.len() - parts;
        for i in &mut code[first..] {
            i.dst = to;
        }
        true
    }

    /// Records that the value of `e` is in `slot` from layer `level` on.
    pub fn memoize(&mut self, e: ExprId, slot: Slot, level: Level) {
        self.values.insert(e, Place::new(slot, level));
        self.layers[level].defined.push(e);
    }

    fn operand(&mut self, e: ExprId) -> (Slot, Level) {
        match self.lookup(e) {
            Some(found) => found,
            None => (self.literal(0.0), PARAMETER),
        }
    }

    fn lookup(&mut self, e: ExprId) -> Option<(Slot, Level)> {
        match self.dae.graph.node(e) {
            Node::Const(c) => Some((self.literal(c.register()), PARAMETER)),
            Node::Time => Some((self.layout.time, self.continuous_level)),
            Node::Var(v) if !self.substitutions.contains(v) => Some(self.variable(v)),
            Node::Pre(v) => Some((self.pre_slot(v), DISCRETE)),
            Node::Initial => Some((self.layout.initial, DISCRETE)),
            Node::Terminal => {
                self.events.reads_terminal = true;
                Some((self.layout.terminal, DISCRETE))
            }
            Node::Relation(k) => Some((self.layout.relations + k, DISCRETE)),
            Node::Recorded(v, order) => Some((self.recorded(v, order), self.continuous_level)),
            _ => self.values.get(e).map(|place| (place.slot, Level::from(place.level))),
        }
    }

    /// The slot of a derivative of an input signal. Slots for all derivatives up to `order` are
    /// allocated, and one for the next order, which gives the rate at events.
    pub fn recorded(&mut self, v: VarId, order: u32) -> Slot {
        for k in 0..=order + 1 {
            if !self.layout.signals.iter().any(|r| (r.0, r.1) == (v, k)) {
                let slot = self.new_slot(0.0);
                self.layout.signals.push((v, k, slot));
            }
        }
        let found = self.layout.signals.iter().find(|r| (r.0, r.1) == (v, order));
        found.map_or(0, |(.., slot)| *slot)
    }

    fn variable(&mut self, v: VarId) -> (Slot, Level) {
        let level = self.levels[v.idx()].unwrap_or_else(|| {
            let name = self.dae.variables.get(v).map_or("", |x| x.name.as_str());
            self.problems.push(error::undetermined(name, self.span));
            DISCRETE
        });
        (self.slot(v), level)
    }

    /// `pre` of a variable that is constant between events is the variable itself.
    pub fn pre_slot(&mut self, v: VarId) -> Slot {
        self.pre_slots.get(&v).copied().unwrap_or_else(|| self.slot(v))
    }

    fn emit_node(&mut self, e: ExprId) {
        match self.dae.graph.node(e) {
            Node::Unary(op, a) => {
                let ty = self.dae.graph.ty(a);
                let op = string_ops::unary(&mut self.dae.graph, op, ty);
                let (a, level) = self.operand(a);
                match op {
                    Unary::Ordinal => self.alias(e, (a, level)),
                    Unary::Neg => self.emit_op(e, Op::Neg, level, a, a),
                    Unary::Carried(_) => {
                        self.emit_op(e, Op::Unary(op), level.max(self.continuous_level), a, a);
                    }
                    _ => self.emit_op(e, Op::Unary(op), level, a, a),
                }
            }
            Node::Binary(op, a, b) => {
                let ty = self.dae.graph.ty(a);
                let op = string_ops::binary(&mut self.dae.graph, op, ty);
                let ((a, la), (b, lb)) = (self.operand(a), self.operand(b));
                let op = match op {
                    Binary::Add => Op::Add,
                    Binary::Sub => Op::Sub,
                    Binary::Mul => Op::Mul,
                    Binary::Div => Op::Div,
                    _ => Op::Binary(op),
                };
                self.emit_op(e, op, la.max(lb), a, b);
            }
            Node::If(c, a, b) => {
                let (c, lc) = self.operand(c);
                let ((a, la), (b, lb)) = (self.operand(a), self.operand(b));
                let layer = self.layer_for(lc.max(la).max(lb));
                let dst = self.new_slot(0.0);
                self.push(layer, Op::Copy, dst, b, b);
                self.push(layer, Op::CopyIf, dst, c, a);
                self.memoize(e, dst, layer);
            }
            Node::NoEvent(a) | Node::Smooth(_, a) | Node::Homotopy(a, _) => {
                let found = self.operand(a);
                self.alias(e, found);
            }
            Node::Var(v) => {
                let found = self.substitutions.get(v).copied().map(|r| self.operand(r));
                self.alias(e, found.unwrap_or((0, PARAMETER)));
            }
            Node::Call { function, output, args } => {
                let (base, level) = self.call(function, args);
                self.alias(e, (base + output, level));
            }
            Node::Sample(..) => self.unsupported(e, "sample() outside of a when-clause"),
            Node::Der(_) => self.unsupported(e, "der() that was not reduced to a variable"),
            // Leaves are found by `lookup`.
            _ => self.unsupported(e, "this expression"),
        }
    }

    fn unsupported(&mut self, e: ExprId, what: &str) {
        self.problems.push(error::not_supported(self.span, what));
        let zero = self.literal(0.0);
        self.alias(e, (zero, PARAMETER));
    }

    fn alias(&mut self, e: ExprId, (slot, level): (Slot, Level)) {
        self.memoize(e, slot, level);
    }

    fn emit_op(&mut self, e: ExprId, op: Op, level: Level, a: Slot, b: Slot) {
        let layer = self.layer_for(level);
        let dst = self.new_slot(0.0);
        self.push(layer, op, dst, a, b);
        self.memoize(e, dst, layer);
    }

    /// Calls a function once for all its outputs; returns the first result.
    fn call(&mut self, function: FunctionId, args: ListId) -> (Slot, Level) {
        if let Some(known) = self.call_results.get(&(function, args)) {
            return *known;
        }
        let mut level = PARAMETER;
        let mut slots = Vec::new();
        for arg in self.dae.graph.list(args).to_vec() {
            let (slot, l) = self.operand(arg);
            level = level.max(l);
            slots.push(slot);
        }
        let (called, partial) = self.derivatives.called(function);
        let outputs = if partial.is_some() { 1 } else { self.dae.functions[called].outputs.len() };
        let base = self.new_slots(outputs.max(1), 0.0);
        let results = (base..base + outputs as Slot).collect();
        // Derivatives are needed where the values are.
        let primal = self.derivatives.primal(&mut self.dae, called, args);
        let condition = self.sink_conditions.get(&primal).copied().map(|g| self.emit(g));
        // A continuously varying call is sunk to its condition. A call that changes less often than
        // the condition is computed unconditionally.
        let condition = condition.filter(|(_, l)| *l <= level || level >= CONTINUOUS);
        level = condition.map_or(level, |(_, l)| level.max(l));
        let condition = condition.map(|(slot, _)| slot);
        let memoizes = !slots.is_empty() && self.expensive_functions.contains(&called);
        let memo = memoizes.then(|| self.new_slots(slots.len(), f64::NAN));
        self.routines.calls.push(CallSite {
            function: called.idx(),
            args: slots,
            results,
            partial,
            condition,
            memo,
        });
        let layer = self.layer_for(level);
        self.push(layer, Op::Call, base, (self.routines.calls.len() - 1) as Slot, 0);
        self.call_results.insert((function, args), (base, layer));
        self.layers[layer].defined_calls.push((function, args));
        (base, layer)
    }

    /// The highest level among the leaves of `roots`, ignoring variables for which `skip` is true.
    pub fn level_of(&self, roots: &[ExprId], skip: impl Fn(VarId) -> bool) -> Level {
        let graph = &self.dae.graph;
        let mut level = PARAMETER;
        graph.descend(roots.iter().copied(), |e, pending| {
            match graph.node(e) {
                Node::Time | Node::Recorded(..) | Node::Unary(Unary::Carried(_), _) => {
                    level = level.max(self.continuous_level);
                }
                Node::Pre(_) | Node::Initial | Node::Terminal | Node::Relation(_) => {
                    level = level.max(DISCRETE);
                }
                Node::Var(v) => match self.substitutions.get(v) {
                    Some(r) => pending.push(*r),
                    None if skip(v) => {}
                    None => level = level.max(self.levels[v.idx()].unwrap_or(DISCRETE)),
                },
                _ => {}
            }
            true
        });
        level
    }

    /// The variables below `roots` in order of first use, eliminated ones replaced by those in
    /// their definition.
    pub fn reads(&self, roots: &[ExprId]) -> Vec<VarId> {
        let graph = &self.dae.graph;
        let mut found = Vec::new();
        graph.descend(roots.iter().copied(), |e, pending| {
            if let Node::Var(v) = graph.node(e) {
                match self.substitutions.get(v) {
                    Some(r) => pending.push(*r),
                    None => found.push(v),
                }
            }
            true
        });
        found
    }

    /// The expression that reads `v`.
    pub fn read(&mut self, v: VarId) -> ExprId {
        let ty = self.dae.variables.get(v).map_or(Type::Real, |x| x.ty);
        self.dae.graph.var(v, ty)
    }

    /// True if the value of the variable is known before initialization.
    pub fn is_parameter(&self, v: VarId) -> bool {
        self.dae.variables.get(v).is_some_and(|x| x.kind == VariableKind::Parameter)
    }
}
