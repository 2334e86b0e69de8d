//! Compiles functions that are called at run time: statements become code with jumps over fixed
//! slots.
//!
//! A function owns the slots of its locals, so calls need no stack. A recursive function saves them
//! in a frame (`runtime::frame`).

use crate::base::index::{FastMap, FastSet, Id, IndexVec};
use crate::base::source::Span;
use crate::ir::dae::Dae;
use crate::ir::expr::{ExprId, FunctionId, Graph, ListId, Node, Unary, VarId};
use crate::ir::flat::{AssertionLevel, Function, LocalId, Statement};
use crate::ir::program::{CallSite, FunctionCode, Instr, Op, Slot, Tape};

use super::derivative_function::Derivatives;
use super::emit::Emitter;
use super::error;
use super::lazy_branches::{Schedule, short_circuit};
use super::string_ops;

/// Compiles the functions that the model calls, once all calls are known. The others have no code.
pub fn compile_called(e: &mut Emitter) {
    let mut is_called: IndexVec<FunctionId, bool> = IndexVec::filled(false, e.dae.functions.len());
    for k in 0..e.routines.calls.len() {
        let f = FunctionId::from_usize(e.routines.calls[k].function);
        if !std::mem::replace(&mut is_called[f], true) {
            reached(&e.dae, &e.derivatives, f).into_iter().for_each(|g| is_called[g] = true);
        }
    }
    for f in e.dae.functions.ids() {
        let code = match is_called[f] {
            true => compile(e, f),
            false => FunctionCode::default(),
        };
        e.routines.functions.push(code);
    }
}

fn compile(e: &mut Emitter, f: FunctionId) -> FunctionCode {
    let function = e.dae.functions[f].clone();
    e.span = function.span;
    let is_recursive = reached(&e.dae, &e.derivatives, f).contains(&f);
    FunctionCode { is_recursive, ..Body::compile(e, &function) }
}

/// The functions that `f` calls directly or indirectly, including `f` if it is recursive.
pub fn reached(dae: &Dae, derivatives: &Derivatives, f: FunctionId) -> Vec<FunctionId> {
    let mut seen: IndexVec<FunctionId, bool> = IndexVec::filled(false, dae.functions.len());
    let mut pending = callees(dae, derivatives, f);
    let mut found = Vec::new();
    while let Some(g) = pending.pop() {
        if g.idx() < seen.len() && !std::mem::replace(&mut seen[g], true) {
            found.push(g);
            pending.extend(callees(dae, derivatives, g));
        }
    }
    found
}

/// The functions that the body of `f` calls.
fn callees(dae: &Dae, derivatives: &Derivatives, f: FunctionId) -> Vec<FunctionId> {
    let nodes = dae.graph.postorder(dae.functions[f].values());
    let calls = nodes.into_iter().filter_map(|n| match dae.graph.node(n) {
        Node::Call { function, .. } => Some(derivatives.called(function).0),
        _ => None,
    });
    calls.collect()
}

/// The expression that an assignment or assertion computes.
fn value_of(statement: &Statement) -> Option<ExprId> {
    match statement {
        Statement::Assign(_, value) => Some(*value),
        Statement::Assert(assert, _) if assert.level == AssertionLevel::Error => {
            Some(assert.condition)
        }
        _ => None,
    }
}

/// The longest prefix of assignments and assertions that do not read each other's results, so that
/// they can be computed together.
fn independent<'s>(graph: &Graph, list: &'s [Statement]) -> &'s [Statement] {
    let mut assigned: FastSet<VarId> = FastSet::default();
    let mut is_independent = |statement: &Statement| {
        let reads = |_, node| matches!(node, Node::Var(v) if assigned.contains(&v));
        match statement {
            Statement::Assign(local, value) => {
                !graph.any([*value], reads) && assigned.insert(VarId(local.0))
            }
            Statement::Assert(a, _) => !graph.any([a.condition, a.message], reads),
            _ => false,
        }
    };
    let count = list.iter().position(|s| !is_independent(s)).unwrap_or(list.len());
    let list = &list[..count.max(1)];
    // An assertion may stop a recursion, so it comes before the calls.
    let is_call = |_, node| matches!(node, Node::Call { .. });
    let calls = |s: &Statement| graph.any(value_of(s), is_call);
    let asserts = |s: &&Statement| matches!(s, Statement::Assert(..)) && !calls(s);
    match list.iter().take_while(asserts).count() {
        first if first > 0 && list[first..].iter().any(calls) => &list[..first],
        _ => list,
    }
}

/// Number of operations up to which executing a branch is cheaper than jumping over it.
const CHEAP_BRANCH: usize = 4;

fn is_cheap(graph: &Graph, list: &[ExprId]) -> bool {
    let costs = |n: &&ExprId| !matches!(graph.node(**n), Node::Const(_) | Node::Var(_));
    let calls = |n: &ExprId| matches!(graph.node(*n), Node::Call { .. });
    !list.iter().any(calls) && list.iter().filter(costs).count() <= CHEAP_BRANCH
}

/// The slots of computed expressions, and of the first results of calls.
#[derive(Default)]
struct ComputedValues {
    slots: FastMap<ExprId, Slot>,
    calls: FastMap<(FunctionId, ListId), Slot>,
}

/// A function under construction.
struct Body {
    locals: Vec<Slot>,
    tape: Tape,
    messages: Vec<(Slot, Span)>,
    /// Jumps to the end of the loop that is being compiled.
    breaks: Vec<usize>,
    /// Jumps to the end of the function.
    returns: Vec<usize>,
}

impl Body {
    fn compile(e: &mut Emitter, function: &Function) -> FunctionCode {
        let first = e.new_slots(function.locals.len(), 0.0);
        let locals: Vec<Slot> = (0..function.locals.len() as Slot).map(|i| first + i).collect();
        let slots = |ids: &[LocalId]| ids.iter().map(|l| locals[l.idx()]).collect();
        let (inputs, outputs) = (slots(&function.inputs), slots(&function.outputs));
        let mut body = Body {
            locals,
            tape: Tape::default(),
            messages: Vec::new(),
            breaks: Vec::new(),
            returns: Vec::new(),
        };
        body.statements(e, &function.body);
        for at in std::mem::take(&mut body.returns) {
            body.patch(at);
        }
        FunctionCode {
            tape: body.tape,
            inputs,
            outputs,
            locals: body.locals,
            messages: body.messages,
            frame: first..e.image.len() as Slot,
            is_recursive: false,
        }
    }

    fn statements(&mut self, e: &mut Emitter, body: &[Statement]) {
        let mut rest = body;
        while let Some((statement, next)) = rest.split_first() {
            let from_here = std::mem::replace(&mut rest, next);
            match statement {
                Statement::Assign(..) | Statement::Assert(..) => {
                    let all = independent(&e.dae.graph, from_here);
                    rest = &from_here[all.len()..];
                    self.independent_group(e, all);
                }
                Statement::If(condition, a, b) => {
                    let condition = short_circuit(&mut e.dae.graph, *condition);
                    let c = self.value(e, condition);
                    let unless = self.push(Op::JumpUnless, 0, c, 0);
                    self.statements(e, a);
                    let over = self.push(Op::Jump, 0, 0, 0);
                    self.patch(unless);
                    self.statements(e, b);
                    self.patch(over);
                }
                Statement::While(condition, a) => {
                    let top = self.tape.len() as Slot;
                    let c = self.value(e, *condition);
                    let unless = self.push(Op::JumpUnless, 0, c, 0);
                    let outer = std::mem::take(&mut self.breaks);
                    self.statements(e, a);
                    self.push(Op::Jump, 0, top, 0);
                    self.patch(unless);
                    for at in std::mem::replace(&mut self.breaks, outer) {
                        self.patch(at);
                    }
                }
                Statement::Break => {
                    let at = self.push(Op::Jump, 0, 0, 0);
                    self.breaks.push(at);
                }
                Statement::Return => {
                    let at = self.push(Op::Jump, 0, 0, 0);
                    self.returns.push(at);
                }
            }
        }
    }

    /// Compiles assignments and assertions that do not depend on each other; common subexpressions
    /// are computed once.
    fn independent_group(&mut self, e: &mut Emitter, all: &[Statement]) {
        let roots: Vec<ExprId> = all.iter().filter_map(value_of).collect();
        let schedule = Schedule::of(&e.dae.graph, &roots);
        let mut computed = ComputedValues::default();
        self.scheduled(e, &schedule, schedule.always(), &mut computed);
        for statement in all {
            let Some(value) = value_of(statement) else { continue };
            let value = computed.slots[&value];
            match statement {
                Statement::Assign(local, _) => {
                    self.push(Op::Copy, self.locals[local.idx()], value, value);
                }
                Statement::Assert(assert, span) => {
                    // The message is computed only if the assertion fails.
                    let no = self.emit_op(e, Op::Unary(Unary::Not), value, value);
                    let unless = self.push(Op::JumpUnless, 0, no, 0);
                    let always =
                        schedule.always().iter().map(|n| (*n, computed.slots[n])).collect();
                    let message = self.value_given(e, assert.message, always);
                    self.messages.push((message, *span));
                    self.push(Op::Assert, 0, value, (self.messages.len() - 1) as Slot);
                    self.patch(unless);
                }
                _ => {}
            }
        }
    }

    fn push(&mut self, op: Op, dst: Slot, a: Slot, b: Slot) -> usize {
        self.tape.push(Instr { op, dst, a, b });
        self.tape.len() - 1
    }

    /// Makes the jump at `at` lead to the next instruction.
    fn patch(&mut self, at: usize) {
        let here = self.tape.len() as Slot;
        let jump = &mut self.tape[at];
        match jump.op {
            Op::JumpUnless => jump.b = here,
            _ => jump.a = here,
        }
    }

    /// Emits an expression over the locals.
    fn value(&mut self, e: &mut Emitter, root: ExprId) -> Slot {
        self.value_given(e, root, FastMap::default())
    }

    /// Emits an expression, given the slots of subexpressions that are already computed.
    fn value_given(&mut self, e: &mut Emitter, root: ExprId, slots: FastMap<ExprId, Slot>) -> Slot {
        let schedule = Schedule::of(&e.dae.graph, &[root]);
        let mut computed = ComputedValues { slots, ..ComputedValues::default() };
        self.scheduled(e, &schedule, schedule.always(), &mut computed);
        computed.slots[&root]
    }

    fn scheduled(
        &mut self,
        e: &mut Emitter,
        schedule: &Schedule,
        list: &[ExprId],
        computed: &mut ComputedValues,
    ) {
        for &n in list {
            if computed.slots.contains_key(&n) {
                continue;
            }
            let slot = match e.dae.graph.node(n) {
                Node::If(c, a, b) => self.conditional(e, schedule, n, [c, a, b], computed),
                Node::Call { function, output, args } => {
                    let base = match computed.calls.get(&(function, args)) {
                        Some(base) => *base,
                        None => self.call(e, function, args, computed),
                    };
                    base + output
                }
                _ => self.node(e, n, &computed.slots),
            };
            computed.slots.insert(n, slot);
        }
    }

    /// Emits an `if` expression; expensive branches are jumped over if they are not taken.
    fn conditional(
        &mut self,
        e: &mut Emitter,
        schedule: &Schedule,
        n: ExprId,
        [c, a, b]: [ExprId; 3],
        computed: &mut ComputedValues,
    ) -> Slot {
        let dst = e.new_slot(0.0);
        let open = |e: &&ExprId| !computed.slots.contains_key(*e);
        let branches = [true, false]
            .map(|holds| schedule.in_branch(n, holds).iter().filter(open).copied().collect());
        let branches: [Vec<ExprId>; 2] = branches;
        if branches.iter().all(|list| is_cheap(&e.dae.graph, list)) {
            branches.iter().for_each(|list| self.scheduled(e, schedule, list, computed));
            self.push(Op::Copy, dst, computed.slots[&b], computed.slots[&b]);
            self.push(Op::CopyIf, dst, computed.slots[&c], computed.slots[&a]);
            return dst;
        }
        let unless = self.push(Op::JumpUnless, 0, computed.slots[&c], 0);
        self.scheduled(e, schedule, &branches[0], computed);
        self.push(Op::Copy, dst, computed.slots[&a], computed.slots[&a]);
        let over = self.push(Op::Jump, 0, 0, 0);
        self.patch(unless);
        self.scheduled(e, schedule, &branches[1], computed);
        self.push(Op::Copy, dst, computed.slots[&b], computed.slots[&b]);
        self.patch(over);
        dst
    }

    /// Emits a call; returns the slot of its first result.
    fn call(
        &mut self,
        e: &mut Emitter,
        f: FunctionId,
        args: ListId,
        computed: &mut ComputedValues,
    ) -> Slot {
        let slots = e.dae.graph.list(args).iter().map(|a| computed.slots[a]).collect();
        let (called, partial) = e.derivatives.called(f);
        let count = if partial.is_some() { 1 } else { e.dae.functions[called].outputs.len() };
        let base = e.new_slots(count.max(1), 0.0);
        e.routines.calls.push(CallSite {
            function: called.idx(),
            args: slots,
            results: (base..base + count as Slot).collect(),
            partial,
            condition: None,
            memo: None,
        });
        self.push(Op::Call, base, (e.routines.calls.len() - 1) as Slot, 0);
        computed.calls.insert((f, args), base);
        base
    }

    /// Emits an expression that is neither an `if` nor a call.
    fn node(&mut self, e: &mut Emitter, n: ExprId, computed: &FastMap<ExprId, Slot>) -> Slot {
        match e.dae.graph.node(n) {
            Node::Const(c) => e.literal(c.register()),
            Node::Var(v) => match self.locals.get(v.idx()) {
                Some(slot) => *slot,
                None => self.unsupported(e, "a variable of the model inside of a function"),
            },
            Node::Unary(op, a) => match op {
                Unary::Ordinal => computed[&a],
                _ => {
                    let ty = e.dae.graph.ty(a);
                    let op = string_ops::unary(&mut e.dae.graph, op, ty);
                    self.emit_op(e, Op::Unary(op), computed[&a], computed[&a])
                }
            },
            Node::Binary(op, a, b) => {
                let ty = e.dae.graph.ty(a);
                let op = string_ops::binary(&mut e.dae.graph, op, ty);
                self.emit_op(e, Op::Binary(op), computed[&a], computed[&b])
            }
            Node::NoEvent(a) | Node::Smooth(_, a) | Node::Homotopy(a, _) => computed[&a],
            _ => self.unsupported(e, "an expression that depends on time inside of a function"),
        }
    }

    fn emit_op(&mut self, e: &mut Emitter, op: Op, a: Slot, b: Slot) -> Slot {
        let dst = e.new_slot(0.0);
        self.push(op, dst, a, b);
        dst
    }

    fn unsupported(&mut self, e: &mut Emitter, what: &str) -> Slot {
        e.problems.push(error::not_supported(e.span, what));
        e.literal(0.0)
    }
}
