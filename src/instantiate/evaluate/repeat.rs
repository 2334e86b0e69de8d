//! Loops whose length only a run knows: they become functions of the flat model.
//!
//! The variables that a loop changes are the locals of such a function. Its body is run once on them
//! as symbols, and what it leaves in them is what one turn assigns. Whatever else the loop reads
//! goes in as an argument.

use super::Context;
use super::algorithm::Flow;
use super::value::Value;
use crate::base::index::{FastMap, FastSet, Id};
use crate::base::name::Name;
use crate::base::source::Span;
use crate::ir::ast::{Expr, Statement};
use crate::ir::expr::{ExprId, FunctionId, Graph, Node, Type, VarId};
use crate::ir::flat::{Function, LocalId, Statement as Step};
use crate::ir::instance::Scope;
use crate::symbolic::rewrite::Rewriter;

/// Numbers of symbols begin here: no model has so many variables.
const FIRST_SYMBOL: u32 = 1 << 30;

/// The k-th symbol.
pub(super) fn symbol(k: u32) -> VarId {
    VarId(FIRST_SYMBOL + k)
}

impl Context<'_> {
    /// Makes a function of `while condition loop body` and assigns its outputs.
    pub(super) fn repeat(
        &mut self,
        condition: &Expr,
        body: &[Statement],
        scope: Scope,
        span: Span,
    ) -> Option<()> {
        let frame = self.evaluation.frame;
        let before: Vec<(Name, Value)> = self.evaluation.locals[frame..].to_vec();
        if !self.evaluation.in_function {
            self.unsupported(span, "loops in models whose length only a run knows");
            return None;
        }
        let changed = changed(body, &before);

        let mut symbols = Vec::new();
        let mut initial = Vec::new();
        for &k in &changed {
            let graph = &mut self.graph;
            let first = &mut self.evaluation.symbols;
            let symbolic = before[k].1.each_scalar(&mut |e| {
                let v = VarId(FIRST_SYMBOL + *first);
                *first += 1;
                symbols.push(v);
                initial.push(e);
                graph.var(v, graph.ty(e))
            });
            self.evaluation.locals[frame + k].1 = symbolic;
        }
        let asserted = self.evaluation.asserts.len();
        let returned = self.evaluation.returned;
        let condition = self.evaluate(condition, scope)?;
        let condition = self.truth(&condition, span)?;
        let flow = self.under(condition, |cx| cx.run_statements(body, scope))?;
        // An assertion about a turn has no place outside of the loop.
        self.evaluation.asserts.truncate(asserted);
        if flow != Flow::Next
            || self.evaluation.broken.is_some()
            || self.evaluation.returned != returned
        {
            self.unsupported(span, "`break` and `return` in loops whose length only a run knows");
            return None;
        }
        let mut turned = Vec::with_capacity(symbols.len());
        for &k in &changed {
            self.evaluation.locals[frame + k].1.for_each_scalar(&mut |e| turned.push(e));
        }
        if turned.len() != symbols.len() {
            self.unsupported(span, "arrays that grow in a loop");
            return None;
        }
        // A whole number may become a real one in the loop.
        let types: Vec<Type> = initial
            .iter()
            .zip(&turned)
            .map(|(before, after)| self.graph.common_type(*before, *after))
            .collect();
        let name = format!("loop {}", self.evaluation.functions.len() + 1);
        let (function, captured) =
            function(&mut self.graph, name, span, &symbols, condition, &turned);
        self.evaluation.functions.push(function);
        let id = FunctionId::from_usize(self.evaluation.functions.len() - 1);

        let mut arguments = initial;
        arguments.extend(captured);
        let args = self.graph.intern_list(&arguments);
        let mut output = 0;
        for &k in &changed {
            let graph = &mut self.graph;
            let result = before[k].1.each_scalar(&mut |_| {
                let call = Node::Call { function: id, output, args };
                let ty = types[output as usize];
                output += 1;
                graph.intern(call, ty)
            });
            self.evaluation.locals[frame + k].1 = result;
        }
        Some(())
    }
}

/// Positions of the locals that a turn may change.
fn changed(body: &[Statement], locals: &[(Name, Value)]) -> Vec<usize> {
    let mut names: FastSet<Name> = FastSet::default();
    super::deduce::assigned(body, &mut names);
    (0..locals.len()).filter(|k| names.contains(&locals[*k].0)).collect()
}

/// The function of a loop over symbols, and what it reads besides them.
fn function(
    graph: &mut Graph,
    name: String,
    span: Span,
    symbols: &[VarId],
    condition: ExprId,
    turned: &[ExprId],
) -> (Function, Vec<ExprId>) {
    let mut locals: FastMap<VarId, u32> = FastMap::default();
    for (k, v) in symbols.iter().enumerate() {
        locals.insert(*v, k as u32);
    }
    // What reads a symbol is computed inside; the largest parts that do not are arguments.
    let mut inside: FastSet<ExprId> = FastSet::default();
    let roots: Vec<ExprId> = std::iter::once(condition).chain(turned.iter().copied()).collect();
    for n in graph.postorder(roots.iter().copied()) {
        let mut reads = matches!(graph.node(n), Node::Var(v) if locals.contains_key(&v));
        graph.for_each_operand(n, |a| reads |= inside.contains(&a));
        if reads {
            inside.insert(n);
        }
    }
    let mut captured: Vec<ExprId> = Vec::new();
    let mut rewriter = Rewriter::new();
    let mut local = |graph: &mut Graph, root: ExprId| {
        rewriter.apply(graph, root, &mut |g, n| {
            if let Node::Var(v) = g.node(n)
                && let Some(k) = locals.get(&v)
            {
                let ty = g.ty(n);
                return Some(g.var(VarId(*k), ty));
            }
            if inside.contains(&n) || g.as_const(n).is_some() {
                return None;
            }
            let at = captured.iter().position(|c| *c == n).unwrap_or_else(|| {
                captured.push(n);
                captured.len() - 1
            });
            let ty = g.ty(n);
            Some(g.var(VarId((symbols.len() + at) as u32), ty))
        })
    };
    let condition = local(graph, condition);
    let turned: Vec<ExprId> = turned.iter().map(|e| local(graph, *e)).collect();
    let (count, inputs) = (symbols.len(), symbols.len() + captured.len());
    let mut names: Vec<String> = (1..=inputs).map(|k| format!("x{k}")).collect();
    // All are assigned at once: new values first stand beside the old ones.
    names.extend((1..=count).map(|k| format!("next{k}")));
    let id = |k: usize| LocalId::from_usize(k);
    let mut turn: Vec<Step> =
        turned.iter().enumerate().map(|(k, e)| Step::Assign(id(inputs + k), *e)).collect();
    for (k, e) in turned.iter().enumerate().take(count) {
        let ty = graph.ty(*e);
        let next = graph.var(VarId((inputs + k) as u32), ty);
        turn.push(Step::Assign(id(k), next));
    }
    let function = Function {
        name,
        span,
        inputs: (0..inputs).map(id).collect(),
        outputs: (0..count).map(id).collect(),
        locals: names.into_iter().collect(),
        body: vec![Step::While(condition, turn)],
    };
    (function, captured)
}
