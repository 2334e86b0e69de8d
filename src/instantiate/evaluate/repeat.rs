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
use crate::ir::expr::{ExprId, FIRST_SYMBOL, FunctionId, Graph, Node, Type, VarId};
use crate::ir::flat::{Function, LocalId, Statement as Step};
use crate::ir::instance::Scope;
use crate::symbolic::rewrite::Rewriter;

/// The k-th symbol.
pub(super) fn symbol(k: u32) -> VarId {
    VarId(FIRST_SYMBOL + k)
}

/// What one turn of a loop makes of what it finds, in terms of symbols.
#[derive(Default)]
struct Turn {
    symbols: Vec<VarId>,
    /// What the symbols stand for before the first turn.
    initial: Vec<ExprId>,
    /// What they stand for after a turn.
    turned: Vec<ExprId>,
}

impl Turn {
    /// A new symbol for what is `initial` before the first turn.
    fn symbol(&mut self, graph: &mut Graph, counter: &mut u32, initial: ExprId) -> ExprId {
        let v = symbol(*counter);
        *counter += 1;
        self.symbols.push(v);
        self.initial.push(initial);
        graph.var(v, graph.ty(initial))
    }
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
        let changed = changed(body, &before);
        let mut turn = Turn::default();
        for &k in &changed {
            let (graph, counter) = (&mut self.graph, &mut self.evaluation.symbols);
            let symbolic = before[k].1.each_scalar(&mut |e| turn.symbol(graph, counter, e));
            self.evaluation.locals[frame + k].1 = symbolic;
        }
        // In a model, what its algorithm assigns.
        let outside = match self.evaluation.in_function {
            true => FastMap::default(),
            false => self.evaluation.assigned.clone(),
        };
        let mut variables: Vec<VarId> = outside.keys().copied().collect();
        variables.sort_unstable();
        for v in &variables {
            let (graph, counter) = (&mut self.graph, &mut self.evaluation.symbols);
            let symbolic = turn.symbol(graph, counter, outside[v]);
            self.evaluation.assigned.insert(*v, symbolic);
        }
        let asserted = self.evaluation.asserts.len();
        let left = (self.evaluation.broken.take(), self.evaluation.returned.take());
        let condition = self.evaluate(condition, scope)?;
        let condition = self.truth(&condition, span)?;
        let flow = self.under(condition, |cx| cx.run_statements(body, scope))?;
        // An assertion about a turn has no place outside of the loop.
        self.evaluation.asserts.truncate(asserted);
        for &k in &changed {
            self.evaluation.locals[frame + k].1.for_each_scalar(&mut |e| turn.turned.push(e));
        }
        turn.turned.extend(variables.iter().map(|v| self.evaluation.assigned[v]));
        if turn.turned.len() != turn.symbols.len() {
            self.unsupported(span, "arrays that grow in a loop");
            return None;
        }
        if !self.evaluation.in_function && self.evaluation.assigned.len() != variables.len() {
            self.unsupported(
                span,
                "variables that are first assigned in a loop whose length only a run knows",
            );
            return None;
        }
        let (condition, returns) = self.until_left(condition, flow, left, &mut turn);
        let results = self.called_loop(turn, condition, span);
        let mut next = results.iter().copied();
        for &k in &changed {
            let result = before[k].1.each_scalar(&mut |e| next.next().unwrap_or(e));
            self.evaluation.locals[frame + k].1 = result;
        }
        for (v, e) in variables.into_iter().zip(next) {
            self.evaluation.assigned.insert(v, e);
        }
        self.evaluation.broken = left.0;
        self.evaluation.returned = if returns { results.last().copied() } else { left.1 };
        Some(())
    }

    /// A loop that may be left by `break` or `return`, or was left before, goes on while a symbol says
    /// so; a last symbol says whether it was left by `return`. In comes how it was left `before`, out go
    /// the condition for another turn, and whether there is that last symbol.
    fn until_left(
        &mut self,
        condition: ExprId,
        flow: Flow,
        before: (Option<ExprId>, Option<ExprId>),
        turn: &mut Turn,
    ) -> (ExprId, bool) {
        let sure = self.graph.boolean(true);
        let now = |kind: Flow, part: Option<ExprId>| if flow == kind { Some(sure) } else { part };
        let broken = now(Flow::Break, self.evaluation.broken);
        let returned = now(Flow::Return, self.evaluation.returned);
        if broken.or(returned).or(before.0).or(before.1).is_none() {
            return (condition, false);
        }
        let goes_on = self.neither(before.0, before.1);
        let next = self.neither(broken, returned);
        let (graph, counter) = (&mut self.graph, &mut self.evaluation.symbols);
        let goes_on = turn.symbol(graph, counter, goes_on);
        turn.turned.push(next);
        let condition = graph.and(goes_on, condition);
        if let Some(returned) = returned {
            let never = graph.boolean(false);
            turn.symbol(graph, counter, before.1.unwrap_or(never));
            turn.turned.push(returned);
        }
        (condition, returned.is_some())
    }

    /// `not (a or b)`, of conditions that are false where there is none.
    fn neither(&mut self, a: Option<ExprId>, b: Option<ExprId>) -> ExprId {
        let mut result = self.graph.boolean(true);
        for c in [a, b].into_iter().flatten() {
            let not_c = self.graph.not(c);
            result = self.graph.and(result, not_c);
        }
        result
    }

    /// Calls a loop as a function: what its symbols stand for in the end.
    fn called_loop(&mut self, turn: Turn, condition: ExprId, span: Span) -> Vec<ExprId> {
        // A whole number may become a real one in the loop.
        let both = turn.initial.iter().zip(&turn.turned);
        let types: Vec<Type> = both.map(|(a, b)| self.graph.common_type(*a, *b)).collect();
        let name = format!("loop {}", self.evaluation.functions.len() + 1);
        let (function, captured) =
            function(&mut self.graph, name, span, &turn.symbols, condition, &turn.turned);
        self.evaluation.functions.push(function);
        let id = FunctionId::from_usize(self.evaluation.functions.len() - 1);
        let mut arguments = turn.initial;
        arguments.extend(captured);
        let args = self.graph.intern_list(&arguments);
        let calls = types.into_iter().enumerate().map(|(output, ty)| {
            let call = Node::Call { function: id, output: output as u32, args };
            self.graph.intern(call, ty)
        });
        calls.collect()
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
