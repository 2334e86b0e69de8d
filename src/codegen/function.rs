//! Functions that are called at run time: statements to code with jumps over fixed cells.
//!
//! A function owns the cells of its locals, so calls need no stack; therefore functions must not
//! call themselves, directly or through others.

use crate::base::index::{FastMap, Id};
use crate::ir::dae::Dae;
use crate::ir::expr::{ExprId, FunctionId, Node, Type, Unary};
use crate::ir::flat::{Function, Level, Statement};
use crate::ir::program::{CallSite, FunctionCode, Instr, Op, Slot, Tape};
use crate::symbolic::print::print;

use super::emit::Emitter;
use super::error;
use super::text;

/// Compiles all functions of the model.
pub fn compile_all(e: &mut Emitter) {
    for f in e.dae.functions.ids() {
        if reached(&e.dae, f).contains(&f) {
            let function = &e.dae.functions[f];
            e.problems.push(error::recursion(&function.name, function.span));
        }
    }
    for f in e.dae.functions.ids() {
        let function = e.dae.functions[f].clone();
        e.span = function.span;
        let code = Body::compile(e, &function);
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
    let mut values = Vec::new();
    statement_values(&dae.functions[f].body, &mut values);
    let nodes = dae.graph.postorder(values);
    let calls = nodes.into_iter().filter_map(|n| match dae.graph.node(n) {
        Node::Call { function, .. } => Some(function),
        _ => None,
    });
    calls.collect()
}

fn statement_values(body: &[Statement], out: &mut Vec<ExprId>) {
    for statement in body {
        match statement {
            Statement::Assign(_, value) => out.push(*value),
            Statement::If(c, a, b) => {
                out.push(*c);
                statement_values(a, out);
                statement_values(b, out);
            }
            Statement::While(c, a) => {
                out.push(*c);
                statement_values(a, out);
            }
            Statement::Assert(a) => out.push(a.condition),
            Statement::Break | Statement::Return => {}
        }
    }
}

/// A function in the making.
struct Body<'a> {
    function: &'a Function,
    locals: Vec<Slot>,
    tape: Tape,
    messages: Vec<String>,
    /// Jumps to the end of the loop that is being compiled.
    breaks: Vec<usize>,
    /// Jumps to the end of the function.
    returns: Vec<usize>,
}

impl<'a> Body<'a> {
    fn compile(e: &mut Emitter, function: &'a Function) -> FunctionCode {
        let first = e.cells(function.locals.len(), 0.0);
        let locals: Vec<Slot> = (0..function.locals.len() as Slot).map(|i| first + i).collect();
        let cells =
            |ids: &[crate::ir::flat::LocalId]| ids.iter().map(|l| locals[l.idx()]).collect();
        let (inputs, outputs) = (cells(&function.inputs), cells(&function.outputs));
        let mut body = Body {
            function,
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
        }
    }

    fn statements(&mut self, e: &mut Emitter, body: &[Statement]) {
        for statement in body {
            match statement {
                Statement::Assign(local, value) => {
                    let value = self.value(e, *value);
                    let dst = self.locals[local.idx()];
                    self.push(Op::Copy, dst, value, value);
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
                Statement::Assert(assert) if assert.level == Level::Error => {
                    let c = self.value(e, assert.condition);
                    let names = |v: crate::ir::expr::VarId| self.local_name(v.idx());
                    self.messages.push(print(&e.dae.graph, assert.message, &names));
                    let message = (self.messages.len() - 1) as Slot;
                    self.push(Op::Assert, 0, c, message);
                }
                Statement::Assert(_) => {}
            }
        }
    }

    fn local_name(&self, i: usize) -> String {
        self.function.locals.iter().nth(i).cloned().unwrap_or_default()
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

    /// Computes an expression over the locals. Nothing is kept from one statement to the next.
    fn value(&mut self, e: &mut Emitter, root: ExprId) -> Slot {
        let mut known: FastMap<ExprId, Slot> = FastMap::default();
        for n in e.dae.graph.postorder([root]) {
            let slot = self.node(e, n, &known);
            known.insert(n, slot);
        }
        known.get(&root).copied().unwrap_or_default()
    }

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
                    let op = text::unary(op, e.dae.graph.ty(a));
                    self.make(e, Op::Unary(op), known[&a], known[&a])
                }
            },
            Node::Binary(op, a, b) if e.dae.graph.ty(a) == Type::String => {
                let text::Operation { op, swapped, negated } = text::binary(op);
                let (a, b) = if swapped { (b, a) } else { (a, b) };
                let result = self.make(e, op, known[&a], known[&b]);
                if negated { self.make(e, Op::Unary(Unary::Not), result, result) } else { result }
            }
            Node::Binary(op, a, b) => self.make(e, Op::Binary(op), known[&a], known[&b]),
            Node::If(c, a, b) => {
                let dst = self.make(e, Op::Copy, known[&b], known[&b]);
                self.push(Op::CopyIf, dst, known[&c], known[&a]);
                dst
            }
            Node::NoEvent(a) | Node::Smooth(_, a) | Node::Homotopy(a, _) => known[&a],
            Node::Call { function, output, args } => {
                let slots = e.dae.graph.list(args).iter().map(|a| known[a]).collect();
                let count = e.dae.functions[function].outputs.len();
                let base = e.cells(count.max(1), 0.0);
                let results = (base..base + count as Slot).collect();
                let function = function.idx();
                e.calls.push(CallSite {
                    function,
                    args: slots,
                    results,
                    partial: None,
                    guard: None,
                    last: None,
                });
                self.push(Op::Call, base, (e.calls.len() - 1) as Slot, 0);
                base + output
            }
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
