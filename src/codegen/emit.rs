//! Expressions to instructions, each computed once at the rarest level that allows it.
//!
//! The emitter holds a stack of *layers*, each a tape in the making. Layer 0 runs once per run
//! (parameters), layer 1 after each event, higher layers more often or inside of a torn block. The
//! level of an expression is the highest level among its leaves; it is emitted to the layer of that
//! level and remembered, so that equal expressions are computed once for all layers above.

use crate::base::diag::Problems;
use crate::base::index::{FastMap, FastSet, Id};
use crate::base::source::Span;
use crate::base::visited::VisitedSet;
use crate::ir::dae::{Dae, Kind};
use crate::ir::expr::{Binary, ExprId, FunctionId, ListId, Node, Type, Unary, VarId};
use crate::ir::program::{
    AssertCells, Bounds, CallSite, Clock, FunctionCode, Implicit, Instr, Layout, Loop, Op,
    ReinitCells, Slot, Solver, Tape, Watch,
};

use super::error;
use super::sink::{guards, long_functions};
use super::string_ops;

/// How often something is computed: the index of a layer.
pub type Level = usize;

/// Depends on parameters only.
pub const PARAMETER: Level = 0;
/// Changes at events only.
pub const HELD: Level = 1;
/// Moves with time.
pub const MOVING: Level = 2;

/// A tape in the making, and what it computes.
#[derive(Default)]
pub struct Layer {
    /// Instructions.
    pub code: Tape,
    made: Vec<ExprId>,
    made_calls: Vec<(FunctionId, ListId)>,
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
    /// Variables that stand for an expression: eliminated ones, and auxiliary names of calls.
    pub replaced: FastMap<VarId, ExprId>,
    /// Cells of `pre(v)`.
    pub pre: FastMap<VarId, Slot>,
    /// Cell of the start value of a variable.
    pub starts: FastMap<VarId, Slot>,
    /// The stack of layers.
    pub layers: Vec<Layer>,
    /// Moving expressions go to this layer or above.
    pub floor: Level,
    /// Level of time, of states and of whatever moves.
    pub moving: Level,
    /// Torn blocks so far.
    pub solvers: Vec<Solver>,
    /// Derivatives of torn blocks so far.
    pub implicits: Vec<Implicit>,
    /// Mixed blocks so far.
    pub loops: Vec<Loop>,
    /// Calls so far.
    pub calls: Vec<CallSite>,
    /// Functions.
    pub functions: Vec<FunctionCode>,
    /// Partial derivatives of functions: function, output, argument. They are called by the ids
    /// after those of the functions.
    pub partials: Vec<(FunctionId, u32, u32)>,
    /// What flips each relation.
    pub watches: Vec<Watch>,
    /// Clocks.
    pub clocks: Vec<Clock>,
    /// Cells of clocks that the initial tape fills, because initialisation determines them.
    pub late_clocks: Vec<(Slot, ExprId)>,
    /// Reinits.
    pub reinits: Vec<ReinitCells>,
    /// Assertions.
    pub asserts: Vec<AssertCells>,
    /// See [`crate::ir::program::Program::bounds`].
    pub bounds: Vec<Bounds>,
    /// Terminates.
    pub terminates: Vec<Slot>,
    /// `terminal()` is read somewhere.
    pub reads_terminal: bool,
    /// What is wrong.
    pub problems: Problems,
    /// The place that is being compiled.
    pub span: Span,
    literals: FastMap<u64, Slot>,
    known: FastMap<ExprId, (Slot, Level)>,
    known_calls: FastMap<(FunctionId, ListId), (Slot, Level)>,
    /// Conditions under which calls are needed.
    guards: FastMap<(FunctionId, ListId), ExprId>,
    /// Functions of which a call may take long.
    long_functions: FastSet<FunctionId>,
}

impl Emitter {
    /// Nothing compiled yet.
    pub fn new(mut dae: Dae) -> Self {
        let long_functions = long_functions(&dae);
        let guards = guards(&mut dae, &long_functions);
        let count = dae.variables.len();
        let replaced = dae.eliminated.iter().copied().collect();
        Emitter {
            dae,
            image: Vec::new(),
            layout: Layout::default(),
            levels: vec![None; count],
            replaced,
            pre: FastMap::default(),
            starts: FastMap::default(),
            layers: vec![Layer::default()],
            floor: HELD,
            moving: HELD,
            solvers: Vec::new(),
            implicits: Vec::new(),
            loops: Vec::new(),
            calls: Vec::new(),
            functions: Vec::new(),
            partials: Vec::new(),
            watches: Vec::new(),
            clocks: Vec::new(),
            late_clocks: Vec::new(),
            reinits: Vec::new(),
            asserts: Vec::new(),
            bounds: Vec::new(),
            terminates: Vec::new(),
            reads_terminal: false,
            problems: Problems::new(),
            span: Span::NONE,
            literals: FastMap::default(),
            known: FastMap::default(),
            known_calls: FastMap::default(),
            guards,
            long_functions,
        }
    }

    /// A new cell with this value before the run.
    pub fn cell(&mut self, value: f64) -> Slot {
        self.image.push(value);
        (self.image.len() - 1) as Slot
    }

    /// `n` new cells in a row; the first of them.
    pub fn cells(&mut self, n: usize, value: f64) -> Slot {
        let first = self.image.len() as Slot;
        self.image.resize(self.image.len() + n, value);
        first
    }

    /// The cell of a literal.
    pub fn literal(&mut self, value: f64) -> Slot {
        if let Some(slot) = self.literals.get(&value.to_bits()) {
            return *slot;
        }
        let slot = self.cell(value);
        self.literals.insert(value.to_bits(), slot);
        slot
    }

    /// The cells of all literals, ascending.
    pub fn literal_cells(&self) -> Vec<Slot> {
        let mut cells: Vec<Slot> = self.literals.values().copied().collect();
        cells.sort_unstable();
        cells
    }

    /// A further variable with a cell of its own.
    pub fn auxiliary(&mut self, level: Option<Level>) -> VarId {
        let slot = self.cell(0.0);
        self.levels.push(level);
        self.layout.variables.push(slot);
        VarId::from_usize(self.levels.len() - 1)
    }

    /// The cell of a variable.
    pub fn slot(&self, v: VarId) -> Slot {
        self.layout.variables[v.idx()]
    }

    /// Opens a layer on top; returns its level.
    pub fn push_layer(&mut self) -> Level {
        self.layers.push(Layer::default());
        self.layers.len() - 1
    }

    /// Closes the top layer; nothing of it can be read any more.
    pub fn pop_discard(&mut self) -> Tape {
        self.forget_top();
        self.layers.pop().map(|l| l.code).unwrap_or_default()
    }

    /// Forgets what the top layer computed, but keeps its code: its variables are about to change.
    pub fn forget_top(&mut self) {
        if let Some(layer) = self.layers.last_mut() {
            for e in layer.made.drain(..) {
                self.known.remove(&e);
            }
            for call in layer.made_calls.drain(..) {
                self.known_calls.remove(&call);
            }
        }
    }

    /// Closes the top layer; what it computed can be read from layer `target` on.
    pub fn pop_merge(&mut self, target: Level) -> Tape {
        let Some(layer) = self.layers.pop() else { return Tape::default() };
        for e in &layer.made {
            if let Some(k) = self.known.get_mut(e) {
                k.1 = target;
            }
        }
        for call in &layer.made_calls {
            if let Some(k) = self.known_calls.get_mut(call) {
                k.1 = target;
            }
        }
        self.layers[target].made.extend(layer.made);
        self.layers[target].made_calls.extend(layer.made_calls);
        layer.code
    }

    /// Appends an instruction to a layer.
    pub fn push(&mut self, level: Level, op: Op, dst: Slot, a: Slot, b: Slot) {
        self.layers[level].code.push(Instr { op, dst, a, b });
    }

    /// The layer for an expression whose leaves have at most this level.
    pub fn home(&self, level: Level) -> Level {
        if level <= HELD { level } else { level.max(self.floor) }
    }

    /// Emits what is needed to compute `root`; returns its cell and level.
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
                Node::Var(v) => stack.extend(self.replaced.get(&v).map(|r| (*r, false))),
                // The simplified expression is for initialisation by continuation.
                Node::Homotopy(actual, _) => stack.push((actual, false)),
                _ => self.dae.graph.for_each_operand(e, |a| stack.push((a, false))),
            }
            stack[first..].reverse();
        }
        self.operand(root)
    }

    /// Emits `variable := value`; returns the level of the variable from now on.
    pub fn assign(&mut self, v: VarId, value: ExprId) -> Level {
        let dst = self.slot(v);
        let level = self.emit_to(dst, value).max(HELD);
        self.levels[v.idx()] = Some(level);
        level
    }

    /// Emits `cell := value`; returns the level of the value. Writes to layer 1 or above.
    pub fn emit_to(&mut self, dst: Slot, value: ExprId) -> Level {
        let fresh = self.lookup(value).is_none();
        let (slot, level) = self.emit(value);
        let home = self.home(level.max(HELD));
        let own =
            matches!(self.dae.graph.node(value), Node::Unary(..) | Node::Binary(..) | Node::If(..));
        if fresh && own && level == home && self.retarget(home, slot, dst) {
            self.known.insert(value, (dst, level));
        } else {
            self.push(home, Op::Copy, dst, slot, slot);
        }
        home
    }

    /// Lets the last instruction write to `to` instead of `from`; a selection has two.
    fn retarget(&mut self, level: Level, from: Slot, to: Slot) -> bool {
        let code = &mut self.layers[level].code;
        let Some(last) = code.last().copied() else { return false };
        if last.dst != from || matches!(last.op, Op::Call | Op::Solve | Op::Repeat | Op::Implicit) {
            return false;
        }
        let parts = if last.op == Op::CopyIf { 2 } else { 1 };
        let first = code.len() - parts;
        for i in &mut code[first..] {
            i.dst = to;
        }
        true
    }

    /// Makes expressions equal to `e` read `slot` from layer `level` on.
    pub fn remember(&mut self, e: ExprId, slot: Slot, level: Level) {
        self.known.insert(e, (slot, level));
        self.layers[level].made.push(e);
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
            Node::Time => Some((self.layout.time, self.moving)),
            Node::Var(v) if !self.replaced.contains_key(&v) => Some(self.variable(v)),
            Node::Pre(v) => Some((self.pre_cell(v), HELD)),
            Node::Initial => Some((self.layout.initial, HELD)),
            Node::Terminal => {
                self.reads_terminal = true;
                Some((self.layout.terminal, HELD))
            }
            Node::Relation(k) => Some((self.layout.relations + k, HELD)),
            Node::Recorded(v, order) => Some((self.recorded(v, order), self.moving)),
            _ => self.known.get(&e).copied(),
        }
    }

    /// The cell of what a recording says about an input. All derivatives up to the order are there, and
    /// the next one, along which events move.
    pub fn recorded(&mut self, v: VarId, order: u32) -> Slot {
        for k in 0..=order + 1 {
            if !self.layout.recorded.iter().any(|r| (r.0, r.1) == (v, k)) {
                let slot = self.cell(0.0);
                self.layout.recorded.push((v, k, slot));
            }
        }
        let found = self.layout.recorded.iter().find(|r| (r.0, r.1) == (v, order));
        found.map_or(0, |(.., slot)| *slot)
    }

    fn variable(&mut self, v: VarId) -> (Slot, Level) {
        let level = self.levels[v.idx()].unwrap_or_else(|| {
            let name = self.dae.variables.get(v).map_or("", |x| x.name.as_str());
            self.problems.push(error::undetermined(name, self.span));
            HELD
        });
        (self.slot(v), level)
    }

    /// `pre` of what is constant between events is its value.
    fn pre_cell(&mut self, v: VarId) -> Slot {
        self.pre.get(&v).copied().unwrap_or_else(|| self.slot(v))
    }

    fn emit_node(&mut self, e: ExprId) {
        match self.dae.graph.node(e) {
            Node::Unary(op, a) => {
                let op = string_ops::unary(op, self.dae.graph.ty(a));
                let (a, level) = self.operand(a);
                match op {
                    Unary::Ordinal => self.alias(e, (a, level)),
                    Unary::Neg => self.make(e, Op::Neg, level, a, a),
                    Unary::Carried(_) => {
                        self.make(e, Op::Unary(op), level.max(self.moving), a, a);
                    }
                    _ => self.make(e, Op::Unary(op), level, a, a),
                }
            }
            Node::Binary(op, a, b) => {
                let op = string_ops::binary(op, self.dae.graph.ty(a));
                let ((a, la), (b, lb)) = (self.operand(a), self.operand(b));
                let op = match op {
                    Binary::Add => Op::Add,
                    Binary::Sub => Op::Sub,
                    Binary::Mul => Op::Mul,
                    Binary::Div => Op::Div,
                    _ => Op::Binary(op),
                };
                self.make(e, op, la.max(lb), a, b);
            }
            Node::If(c, a, b) => {
                let (c, lc) = self.operand(c);
                let ((a, la), (b, lb)) = (self.operand(a), self.operand(b));
                let home = self.home(lc.max(la).max(lb));
                let dst = self.cell(0.0);
                self.push(home, Op::Copy, dst, b, b);
                self.push(home, Op::CopyIf, dst, c, a);
                self.remember(e, dst, home);
            }
            Node::NoEvent(a) | Node::Smooth(_, a) | Node::Homotopy(a, _) => {
                let found = self.operand(a);
                self.alias(e, found);
            }
            Node::Var(v) => {
                let found = self.replaced.get(&v).copied().map(|r| self.operand(r));
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
        self.remember(e, slot, level);
    }

    fn make(&mut self, e: ExprId, op: Op, level: Level, a: Slot, b: Slot) {
        let home = self.home(level);
        let dst = self.cell(0.0);
        self.push(home, op, dst, a, b);
        self.remember(e, dst, home);
    }

    /// Calls a function once for all its outputs; returns the first result.
    fn call(&mut self, function: FunctionId, args: ListId) -> (Slot, Level) {
        if let Some(known) = self.known_calls.get(&(function, args)) {
            return *known;
        }
        let mut level = PARAMETER;
        let mut slots = Vec::new();
        for arg in self.dae.graph.list(args).to_vec() {
            let (slot, l) = self.operand(arg);
            level = level.max(l);
            slots.push(slot);
        }
        let count = self.dae.functions.len();
        let (called, partial) = match function.idx().checked_sub(count) {
            Some(k) => {
                let (f, output, arg) = self.partials[k];
                (f, Some((output as usize, arg as usize)))
            }
            None => (function, None),
        };
        let outputs = if partial.is_some() { 1 } else { self.dae.functions[called].outputs.len() };
        let base = self.cells(outputs.max(1), 0.0);
        let results = (base..base + outputs as Slot).collect();
        let guard = self.guards.get(&(called, args)).copied().map(|g| self.emit(g));
        // What moves is computed where its condition is; what changes more rarely than the condition, whether
        // it holds or not.
        let guard = guard.filter(|(_, l)| *l <= level || level >= MOVING);
        level = guard.map_or(level, |(_, l)| level.max(l));
        let guard = guard.map(|(slot, _)| slot);
        let remembers = !slots.is_empty() && self.long_functions.contains(&called);
        let last = remembers.then(|| self.cells(slots.len(), f64::NAN));
        self.calls.push(CallSite {
            function: called.idx(),
            args: slots,
            results,
            partial,
            guard,
            last,
        });
        let home = self.home(level);
        self.push(home, Op::Call, base, (self.calls.len() - 1) as Slot, 0);
        self.known_calls.insert((function, args), (base, home));
        self.layers[home].made_calls.push((function, args));
        (base, home)
    }

    /// The highest level among the leaves of `roots`, leaving out variables for which `skip` holds.
    pub fn level_of(&self, roots: &[ExprId], skip: impl Fn(VarId) -> bool) -> Level {
        let graph = &self.dae.graph;
        let mut level = PARAMETER;
        let mut pending = roots.to_vec();
        let mut seen = FastSet::default();
        while let Some(e) = pending.pop() {
            if !seen.insert(e) {
                continue;
            }
            match graph.node(e) {
                Node::Time | Node::Recorded(..) => level = level.max(self.moving),
                Node::Unary(Unary::Carried(_), a) => {
                    level = level.max(self.moving);
                    pending.push(a);
                }
                Node::Pre(_) | Node::Initial | Node::Terminal | Node::Relation(_) => {
                    level = level.max(HELD);
                }
                Node::Var(v) => match self.replaced.get(&v) {
                    Some(r) => pending.push(*r),
                    None if skip(v) => {}
                    None => level = level.max(self.levels[v.idx()].unwrap_or(HELD)),
                },
                _ => graph.for_each_operand(e, |a| pending.push(a)),
            }
        }
        level
    }

    /// The variables below `roots` in order of first use, eliminated ones replaced by what they read.
    pub fn reads(&self, roots: &[ExprId]) -> Vec<VarId> {
        let graph = &self.dae.graph;
        VisitedSet::traverse(graph.len(), |seen| {
            let mut found = Vec::new();
            let mut pending = roots.to_vec();
            // Calls for several outputs share their arguments, which may be many.
            let mut lists = FastSet::default();
            while let Some(e) = pending.pop() {
                if !seen.insert(e.idx()) {
                    continue;
                }
                match graph.node(e) {
                    Node::Var(v) => match self.replaced.get(&v) {
                        Some(r) => pending.push(*r),
                        None => found.push(v),
                    },
                    Node::Call { args, .. } if !lists.insert(args) => {}
                    _ => graph.for_each_operand(e, |a| pending.push(a)),
                }
            }
            found
        })
    }

    /// The expression that reads `v`.
    pub fn read(&mut self, v: VarId) -> ExprId {
        let ty = self.dae.variables.get(v).map_or(Type::Real, |x| x.ty);
        self.dae.graph.var(v, ty)
    }

    /// True if the variable has its value before initialisation.
    pub fn is_parameter(&self, v: VarId) -> bool {
        self.dae.variables.get(v).is_some_and(|x| x.kind == Kind::Parameter)
    }
}
