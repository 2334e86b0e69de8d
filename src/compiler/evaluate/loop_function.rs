//! The function of a loop whose trip count is known only at run time: what is computed inside, the expressions
//! it captures, and the assertions it checks.

use super::assertion::Asserted;
use super::runtime_loop::symbol;
use crate::base::index::{FastMap, FastSet, Id};
use crate::base::source::Span;
use crate::ir::expr::{Binary, Const, ExprId, Graph, Node, Type, VarId};
use crate::ir::flat::{Assert, AssertionLevel, Function, LocalId, Statement as Step};
use crate::symbolic::rewrite::Rewriter;

/// One iteration of a loop, in terms of symbols.
#[derive(Default)]
pub(super) struct Iteration {
    pub(super) symbols: Vec<VarId>,
    /// The values of the symbols before the first iteration.
    pub(super) initial: Vec<ExprId>,
    /// Their values after an iteration.
    pub(super) next_values: Vec<ExprId>,
    /// The assertions of an iteration.
    pub(super) asserts: Vec<Asserted>,
    /// The condition for it.
    pub(super) condition: Option<ExprId>,
    /// The values of all variables before the loop, which are computed whatever happens in it.
    pub(super) computed: Vec<ExprId>,
}

impl Iteration {
    /// A new symbol with the value `initial` before the first iteration.
    pub(super) fn symbol(
        &mut self,
        graph: &mut Graph,
        counter: &mut u32,
        initial: ExprId,
    ) -> ExprId {
        let v = symbol(*counter);
        *counter += 1;
        self.symbols.push(v);
        self.initial.push(initial);
        graph.var(v, graph.ty(initial))
    }
}

/// Nodes that an assertion in a loop may compute in addition to the iteration. One that needs more, such as a
/// value of one branch alone, would slow each iteration down: it is checked by a function of its own.
const MOST_ASSERTED: usize = 32;

/// Nodes of a Boolean argument that only an assertion reads.
const MOST_CAPTURED: usize = 8;

/// Whether these are so few, and none is a call.
fn costs_at_most(graph: &Graph, all: impl IntoIterator<Item = ExprId>, most: usize) -> bool {
    let mut count = 0;
    all.into_iter().all(|n| {
        count += 1;
        count <= most && !matches!(graph.node(n), Node::Call { .. })
    })
}

/// The largest parts below these that are not computed `inside`, but for constants.
fn outside(
    graph: &Graph,
    roots: impl IntoIterator<Item = ExprId>,
    inside: &FastSet<ExprId>,
) -> FastSet<ExprId> {
    let mut seen: FastSet<ExprId> = FastSet::default();
    let mut found = FastSet::default();
    let mut pending: Vec<ExprId> = roots.into_iter().collect();
    while let Some(n) = pending.pop() {
        if graph.as_const(n).is_some() || !seen.insert(n) {
            continue;
        }
        match inside.contains(&n) {
            true => graph.for_each_operand(n, |a| pending.push(a)),
            false => {
                found.insert(n);
            }
        }
    }
    found
}

/// Nodes that are computed whichever branches are taken.
fn always(graph: &Graph, roots: &[ExprId]) -> FastSet<ExprId> {
    let mut found: FastSet<ExprId> = FastSet::default();
    let mut pending = roots.to_vec();
    while let Some(n) = pending.pop() {
        if !found.insert(n) {
            continue;
        }
        match graph.node(n) {
            Node::If(c, ..) => pending.push(c),
            Node::Binary(Binary::And | Binary::Or, a, _) => pending.push(a),
            _ => graph.for_each_operand(n, |a| pending.push(a)),
        }
    }
    found
}

/// A function of a loop over symbols.
pub(super) struct Made {
    pub(super) function: Function,
    /// The expressions it captures: its arguments after the initial values.
    pub(super) captured: Vec<ExprId>,
    /// The assertions that it does not check.
    pub(super) unchecked: Vec<(Assert, Span)>,
}

/// What a function of a loop is for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    /// The final values of the symbols. It checks assertions as far as they cost next to nothing.
    Values,
    /// For each assertion, whether it holds in all iterations, and the message of the first one where it does
    /// not.
    Checks,
}

/// The assertions about an iteration, in which its condition holds.
pub(super) fn assertions(graph: &mut Graph, iteration: &Iteration) -> Vec<(Assert, Span)> {
    let checked = |a: &&Asserted| !matches!(a.level, AssertionLevel::Print(_));
    let mut asserts: Vec<(Assert, Span)> =
        iteration.asserts.iter().filter(checked).map(Asserted::as_statement).collect();
    let mut rewriter = Rewriter::new();
    for (assert, _) in &mut asserts {
        assert.condition = rewriter.apply(graph, assert.condition, &mut |g, n| {
            (Some(n) == iteration.condition).then(|| g.boolean(true))
        });
    }
    let is_sure =
        |(a, _): &(Assert, Span)| graph.as_const(a.condition) == Some(Const::Boolean(true));
    asserts.retain(|a| !is_sure(a));
    asserts
}

/// The function of a loop over symbols.
pub(super) fn function(
    graph: &mut Graph,
    (name, span): (String, Span),
    Iteration { symbols, next_values, computed, .. }: &Iteration,
    condition: ExprId,
    asserts: Vec<(Assert, Span)>,
    purpose: Purpose,
) -> Made {
    let checks = purpose == Purpose::Checks;
    let mut roots: Vec<ExprId> =
        std::iter::once(condition).chain(next_values.iter().copied()).collect();
    let always = always(graph, &roots);
    let (asserts, mut unchecked): (Vec<_>, Vec<_>) = asserts.into_iter().partition(|(a, _)| {
        let more = graph.postorder([a.condition]).into_iter().filter(|n| !always.contains(n));
        checks || a.level == AssertionLevel::Error && costs_at_most(graph, more, MOST_ASSERTED)
    });
    let mut locals: FastMap<VarId, u32> = FastMap::default();
    for (k, v) in symbols.iter().enumerate() {
        locals.insert(*v, k as u32);
    }
    // Expressions that read a symbol are computed inside, and so are calls in branches that may not
    // be taken, unless they were called before the loop; the largest others become arguments.
    let mut inside: FastSet<ExprId> = FastSet::default();
    let mut calls: FastSet<ExprId> = FastSet::default();
    roots.extend(asserts.iter().flat_map(|(a, _)| [a.condition, a.message]));
    let nodes = graph.postorder(roots.iter().copied());
    let is_call = |n: ExprId| matches!(graph.node(n), Node::Call { .. });
    let called = match nodes.iter().any(|n| is_call(*n) && !always.contains(n)) {
        true => self::always(graph, computed),
        false => FastSet::default(),
    };
    for n in nodes {
        let mut reads = matches!(graph.node(n), Node::Var(v) if locals.contains_key(&v));
        let mut has_call = is_call(n) && !called.contains(&n);
        graph.for_each_operand(n, |a| {
            reads |= inside.contains(&a);
            has_call |= calls.contains(&a);
        });
        if has_call {
            calls.insert(n);
        }
        if reads || has_call && !always.contains(&n) {
            inside.insert(n);
        }
    }
    // A message is built where the assertion is checked.
    let messages = graph.postorder(asserts.iter().map(|(a, _)| a.message));
    inside.extend(messages.into_iter().filter(|n| graph.ty(*n) == Type::String));
    // Assertions have few arguments of their own: calls are differentiated by each.
    let read =
        outside(graph, std::iter::once(condition).chain(next_values.iter().copied()), &inside);
    let is_cheap = |graph: &Graph, n: ExprId| {
        graph.ty(n) == Type::Boolean && costs_at_most(graph, graph.postorder([n]), MOST_CAPTURED)
    };
    let (kept, moved): (Vec<_>, Vec<_>) =
        asserts.into_iter().partition(|(a, _): &(Assert, Span)| {
            let mut all = outside(graph, [a.condition], &inside).into_iter();
            let is_read = all.all(|n| read.contains(&n) || is_cheap(graph, n));
            checks || is_read && outside(graph, [a.message], &inside).is_subset(&read)
        });
    let asserts = kept;
    unchecked.extend(moved);
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
    let next_values: Vec<ExprId> = next_values.iter().map(|e| local(graph, *e)).collect();
    let asserts: Vec<(Assert, Span)> = asserts
        .into_iter()
        .map(|(a, span)| {
            let (condition, message) = (local(graph, a.condition), local(graph, a.message));
            (Assert { condition, message, ..a }, span)
        })
        .collect();
    let (count, inputs) = (symbols.len(), symbols.len() + captured.len());
    let mut names: Vec<String> = (1..=inputs).map(|k| format!("x{k}")).collect();
    // All variables are assigned at once: new values are first stored separately.
    names.extend((1..=count).map(|k| format!("next{k}")));
    let id = LocalId::from_usize;
    let mut outputs: Vec<LocalId> = (0..count).map(id).collect();
    let (mut body, mut iteration) = (Vec::new(), Vec::new());
    match purpose {
        Purpose::Values => {
            iteration.extend(asserts.into_iter().map(|(a, span)| Step::Assert(a, span)));
        }
        Purpose::Checks => {
            outputs.clear();
            for (k, (a, _)) in (1..).zip(asserts) {
                let (holds, message) = (id(names.len()), id(names.len() + 1));
                names.extend([format!("holds{k}"), format!("message{k}")]);
                outputs.extend([holds, message]);
                iteration.push(first_violation(graph, &a, holds, message));
                body.push(Step::Assign(holds, graph.boolean(true)));
            }
        }
    }
    iteration.extend(next_values.iter().enumerate().map(|(k, e)| Step::Assign(id(inputs + k), *e)));
    for (k, e) in next_values.iter().enumerate().take(count) {
        let ty = graph.ty(*e);
        let next = graph.var(VarId((inputs + k) as u32), ty);
        iteration.push(Step::Assign(id(k), next));
    }
    body.push(Step::While(condition, iteration));
    let function = Function {
        name,
        span,
        inputs: (0..inputs).map(id).collect(),
        outputs,
        locals: names.into_iter().collect(),
        body,
    };
    Made { function, captured, unchecked }
}

/// Notes that an assertion is false, and its message, unless it was false before.
fn first_violation(graph: &mut Graph, a: &Assert, holds: LocalId, message: LocalId) -> Step {
    let still_holds = graph.var(VarId(holds.0), Type::Boolean);
    let violated = graph.not(a.condition);
    let first = graph.and(still_holds, violated);
    let no = graph.boolean(false);
    Step::If(first, vec![Step::Assign(message, a.message), Step::Assign(holds, no)], Vec::new())
}
