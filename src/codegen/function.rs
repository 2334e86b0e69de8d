//! Functions that are called at run time: statements to code with jumps over fixed cells.
//!
//! A function owns the cells of its locals, so calls need no stack. One that calls itself, directly or
//! through others, puts aside what stands there for as long (`frames`).

use crate::base::index::{FastMap, FastSet, Id};
use crate::base::source::Span;
use crate::ir::dae::Dae;
use crate::ir::expr::{ExprId, FunctionId, Graph, ListId, Node, Unary, VarId};
use crate::ir::flat::{Function, Level, LocalId, Statement};
use crate::ir::program::{CallSite, FunctionCode, Instr, Op, Slot, Tape};

use super::emit::Emitter;
use super::error;
use super::lazy_branches::Plan;
use super::string_ops;

/// Compiles all functions of the model.
pub fn compile_all(e: &mut Emitter) {
    for f in e.dae.functions.ids() {
        let function = e.dae.functions[f].clone();
        e.span = function.span;
        let recurs = reached(&e.dae, f).contains(&f);
        let code = FunctionCode { recurs, ..Body::compile(e, &function) };
        e.functions.push(code);
    }
}

/// The functions that `f` calls, directly or through others; `f` among them if it calls itself.
pub fn reached(dae: &Dae, f: FunctionId) -> Vec<FunctionId> {
    let mut seen = vec![false; dae.functions.len()];
    let mut pending = callees(dae, f);
    let mut found = Vec::new();
    while let Some(g) = pending.pop() {
        if g.idx() < seen.len() && !std::mem::replace(&mut seen[g.idx()], true) {
            found.push(g);
            pending.extend(callees(dae, g));
        }
    }
    found
}

/// The functions that the body of `f` calls.
fn callees(dae: &Dae, f: FunctionId) -> Vec<FunctionId> {
    let nodes = dae.graph.postorder(dae.functions[f].values());
    let calls = nodes.into_iter().filter_map(|n| match dae.graph.node(n) {
        Node::Call { function, .. } => Some(function),
        _ => None,
    });
    calls.collect()
}

/// What a statement computes if it only assigns or asserts.
fn value_of(statement: &Statement) -> Option<ExprId> {
    match statement {
        Statement::Assign(_, value) => Some(*value),
        Statement::Assert(assert, _) if assert.level == Level::Error => Some(assert.condition),
        _ => None,
    }
}

/// The first assignments and assertions of a list that read nothing that one of them assigns: all can be
/// computed at once.
fn independent<'s>(graph: &Graph, list: &'s [Statement]) -> &'s [Statement] {
    let mut assigned: FastSet<VarId> = FastSet::default();
    let mut stands_alone = |statement: &Statement| {
        let reads = |n: ExprId| matches!(graph.node(n), Node::Var(v) if assigned.contains(&v));
        match statement {
            Statement::Assign(local, value) => {
                !graph.postorder([*value]).into_iter().any(reads) && assigned.insert(VarId(local.0))
            }
            Statement::Assert(a, _) => {
                !graph.postorder([a.condition, a.message]).into_iter().any(reads)
            }
            _ => false,
        }
    };
    let count = list.iter().position(|s| !stands_alone(s)).unwrap_or(list.len());
    let list = &list[..count.max(1)];
    // What is asserted may be what keeps calls from going on without an end.
    let is_call = |n: &ExprId| matches!(graph.node(*n), Node::Call { .. });
    let calls = |s: &Statement| graph.postorder(value_of(s)).iter().any(is_call);
    let asserts = |s: &&Statement| matches!(s, Statement::Assert(..)) && !calls(s);
    match list.iter().take_while(asserts).count() {
        first if first > 0 && list[first..].iter().any(calls) => &list[..first],
        _ => list,
    }
}

/// A branch of so few operations costs less than a jump over it.
const SHORT: usize = 4;

fn is_short(graph: &Graph, list: &[ExprId]) -> bool {
    let costs = |n: &&ExprId| !matches!(graph.node(**n), Node::Const(_) | Node::Var(_));
    let calls = |n: &ExprId| matches!(graph.node(*n), Node::Call { .. });
    !list.iter().any(calls) && list.iter().filter(costs).count() <= SHORT
}

/// The cells of what is computed, and those of the first results of calls.
#[derive(Default)]
struct Known {
    slots: FastMap<ExprId, Slot>,
    calls: FastMap<(FunctionId, ListId), Slot>,
}

/// A function in the making.
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
        let first = e.cells(function.locals.len(), 0.0);
        let locals: Vec<Slot> = (0..function.locals.len() as Slot).map(|i| first + i).collect();
        let cells = |ids: &[LocalId]| ids.iter().map(|l| locals[l.idx()]).collect();
        let (inputs, outputs) = (cells(&function.inputs), cells(&function.outputs));
        let mut body = Body {
            locals,
            tape: Tape::default(),
            messages: Vec::new(),
            breaks: Vec::new(),
            returns: Vec::new(),
        };
        body.statements(e, &function.body);
        for at in std::mem::take(&mut body.returns) {
            body.land(at);
        }
        FunctionCode {
            tape: body.tape,
            inputs,
            outputs,
            locals: body.locals,
            messages: body.messages,
            frame: first..e.image.len() as Slot,
            recurs: false,
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
                    self.together(e, all);
                }
                Statement::If(condition, a, b) => {
                    let c = self.value(e, *condition);
                    let unless = self.push(Op::JumpUnless, 0, c, 0);
                    self.statements(e, a);
                    let over = self.push(Op::Jump, 0, 0, 0);
                    self.land(unless);
                    self.statements(e, b);
                    self.land(over);
                }
                Statement::While(condition, a) => {
                    let top = self.tape.len() as Slot;
                    let c = self.value(e, *condition);
                    let unless = self.push(Op::JumpUnless, 0, c, 0);
                    let outer = std::mem::take(&mut self.breaks);
                    self.statements(e, a);
                    self.push(Op::Jump, 0, top, 0);
                    self.land(unless);
                    for at in std::mem::replace(&mut self.breaks, outer) {
                        self.land(at);
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

    /// Assignments and assertions that do not depend on each other: what they share is computed once.
    fn together(&mut self, e: &mut Emitter, all: &[Statement]) {
        let roots: Vec<ExprId> = all.iter().filter_map(value_of).collect();
        let plan = Plan::of(&e.dae.graph, &roots);
        let mut known = Known::default();
        self.planned(e, &plan, plan.always(), &mut known);
        for statement in all {
            let Some(value) = value_of(statement) else { continue };
            let value = known.slots[&value];
            match statement {
                Statement::Assign(local, _) => {
                    self.push(Op::Copy, self.locals[local.idx()], value, value);
                }
                Statement::Assert(assert, span) => {
                    // What it says is put together where it is said only.
                    let no = self.make(e, Op::Unary(Unary::Not), value, value);
                    let unless = self.push(Op::JumpUnless, 0, no, 0);
                    let always = plan.always().iter().map(|n| (*n, known.slots[n])).collect();
                    let message = self.value_beside(e, assert.message, always);
                    self.messages.push((message, *span));
                    self.push(Op::Assert, 0, value, (self.messages.len() - 1) as Slot);
                    self.land(unless);
                }
                _ => {}
            }
        }
    }

    fn push(&mut self, op: Op, dst: Slot, a: Slot, b: Slot) -> usize {
        self.tape.push(Instr { op, dst, a, b });
        self.tape.len() - 1
    }

    /// Lets the jump at `at` lead to the next instruction.
    fn land(&mut self, at: usize) {
        let here = self.tape.len() as Slot;
        let jump = &mut self.tape[at];
        match jump.op {
            Op::JumpUnless => jump.b = here,
            _ => jump.a = here,
        }
    }

    /// Computes an expression over the locals.
    fn value(&mut self, e: &mut Emitter, root: ExprId) -> Slot {
        self.value_beside(e, root, FastMap::default())
    }

    /// Computes an expression beside what is known.
    fn value_beside(
        &mut self,
        e: &mut Emitter,
        root: ExprId,
        slots: FastMap<ExprId, Slot>,
    ) -> Slot {
        let plan = Plan::of(&e.dae.graph, &[root]);
        let mut known = Known { slots, ..Known::default() };
        self.planned(e, &plan, plan.always(), &mut known);
        known.slots[&root]
    }

    fn planned(&mut self, e: &mut Emitter, plan: &Plan, list: &[ExprId], known: &mut Known) {
        for &n in list {
            if known.slots.contains_key(&n) {
                continue;
            }
            let slot = match e.dae.graph.node(n) {
                Node::If(c, a, b) => self.choice(e, plan, n, [c, a, b], known),
                Node::Call { function, output, args } => {
                    let base = match known.calls.get(&(function, args)) {
                        Some(base) => *base,
                        None => self.call(e, function, args, known),
                    };
                    base + output
                }
                _ => self.node(e, n, &known.slots),
            };
            known.slots.insert(n, slot);
        }
    }

    /// What is computed in one branch alone is jumped over where it is long.
    fn choice(
        &mut self,
        e: &mut Emitter,
        plan: &Plan,
        n: ExprId,
        [c, a, b]: [ExprId; 3],
        known: &mut Known,
    ) -> Slot {
        let dst = e.cell(0.0);
        let branches = [true, false].map(|holds| plan.in_branch(n, holds));
        if branches.iter().all(|list| is_short(&e.dae.graph, list)) {
            branches.into_iter().for_each(|list| self.planned(e, plan, list, known));
            self.push(Op::Copy, dst, known.slots[&b], known.slots[&b]);
            self.push(Op::CopyIf, dst, known.slots[&c], known.slots[&a]);
            return dst;
        }
        let unless = self.push(Op::JumpUnless, 0, known.slots[&c], 0);
        self.planned(e, plan, branches[0], known);
        self.push(Op::Copy, dst, known.slots[&a], known.slots[&a]);
        let over = self.push(Op::Jump, 0, 0, 0);
        self.land(unless);
        self.planned(e, plan, branches[1], known);
        self.push(Op::Copy, dst, known.slots[&b], known.slots[&b]);
        self.land(over);
        dst
    }

    /// Calls a function: the cell of its first result.
    fn call(&mut self, e: &mut Emitter, f: FunctionId, args: ListId, known: &mut Known) -> Slot {
        let slots = e.dae.graph.list(args).iter().map(|a| known.slots[a]).collect();
        let count = e.dae.functions[f].outputs.len();
        let base = e.cells(count.max(1), 0.0);
        e.calls.push(CallSite {
            function: f.idx(),
            args: slots,
            results: (base..base + count as Slot).collect(),
            partial: None,
            guard: None,
            last: None,
        });
        self.push(Op::Call, base, (e.calls.len() - 1) as Slot, 0);
        known.calls.insert((f, args), base);
        base
    }

    /// What is neither a choice nor a call.
    fn node(&mut self, e: &mut Emitter, n: ExprId, known: &FastMap<ExprId, Slot>) -> Slot {
        match e.dae.graph.node(n) {
            Node::Const(c) => e.literal(c.register()),
            Node::Var(v) => match self.locals.get(v.idx()) {
                Some(slot) => *slot,
                None => self.unsupported(e, "a variable of the model inside of a function"),
            },
            Node::Unary(op, a) => match op {
                Unary::Ordinal => known[&a],
                _ => {
                    let op = string_ops::unary(op, e.dae.graph.ty(a));
                    self.make(e, Op::Unary(op), known[&a], known[&a])
                }
            },
            Node::Binary(op, a, b) => {
                let op = string_ops::binary(op, e.dae.graph.ty(a));
                self.make(e, Op::Binary(op), known[&a], known[&b])
            }
            Node::NoEvent(a) | Node::Smooth(_, a) | Node::Homotopy(a, _) => known[&a],
            _ => self.unsupported(e, "an expression that depends on time inside of a function"),
        }
    }

    fn make(&mut self, e: &mut Emitter, op: Op, a: Slot, b: Slot) -> Slot {
        let dst = e.cell(0.0);
        self.push(op, dst, a, b);
        dst
    }

    fn unsupported(&mut self, e: &mut Emitter, what: &str) -> Slot {
        e.problems.push(error::not_supported(e.span, what));
        e.literal(0.0)
    }
}
