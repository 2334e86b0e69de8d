//! Loops whose trip count is known only at run time: they become functions of the flat model.
//!
//! The variables that a loop changes are the locals of such a function. Its body is executed once
//! on them as symbols; their final values are the assignments of one iteration. Anything else that
//! the loop reads is passed as an argument.

use super::Evaluator;
use super::algorithm::{Exits, Flow};
use super::assertion::Asserted;
use super::value::Value;
use crate::base::index::{FastMap, FastSet, Id};
use crate::base::name::Name;
use crate::base::source::Span;
use crate::classes::unsupported::Construct;
use crate::ir::ast::{Expr, ExprKind, Iterator as Loop, Statement};
use crate::ir::expr::{Binary, Const, ExprId, FIRST_SYMBOL, FunctionId, Graph, Node, Type, VarId};
use crate::ir::flat::{Assert, Function, LocalId, Statement as Step};
use crate::ir::instance::Scope;
use crate::symbolic::rewrite::Rewriter;

/// The k-th symbol.
pub(crate) fn symbol(k: u32) -> VarId {
    VarId(FIRST_SYMBOL + k)
}

/// Functions of the flat model that are made of loops and of functions that call themselves.
#[derive(Default)]
pub struct Loops {
    /// All of them.
    pub(crate) functions: Vec<Function>,
    /// Those made of loops, by source span, number of arguments and expressions: an identical loop
    /// is reused.
    pub(super) by_body: FastMap<(Span, usize, Vec<ExprId>), FunctionId>,
    /// How many symbols such functions have.
    pub(super) symbols: u32,
}

/// One iteration of a loop, in terms of symbols.
#[derive(Default)]
struct Iteration {
    symbols: Vec<VarId>,
    /// The values of the symbols before the first iteration.
    initial: Vec<ExprId>,
    /// Their values after an iteration.
    next_values: Vec<ExprId>,
    /// The assertions of an iteration.
    asserts: Vec<Asserted>,
    /// The condition for it.
    condition: Option<ExprId>,
}

impl Iteration {
    /// A new symbol with the value `initial` before the first iteration.
    fn symbol(&mut self, graph: &mut Graph, counter: &mut u32, initial: ExprId) -> ExprId {
        let v = symbol(*counter);
        *counter += 1;
        self.symbols.push(v);
        self.initial.push(initial);
        graph.var(v, graph.ty(initial))
    }
}

/// A range whose bounds are known only at run time.
struct Range {
    start: ExprId,
    step: ExprId,
    stop: ExprId,
}

impl Evaluator<'_> {
    /// Makes a function of `while condition loop body` and assigns its outputs.
    pub(crate) fn while_as_function(
        &mut self,
        condition: &Expr,
        body: &[Statement],
        scope: Scope,
    ) -> Option<()> {
        let mut names = FastSet::default();
        super::implicit_ranges::assigned(body, &mut names);
        self.loop_as_function(&names, condition.span, |cx| {
            let value = cx.evaluate(condition, scope)?;
            let holds = cx.boolean_of(&value, condition.span)?;
            let flow = cx.under(holds, |cx| cx.run_statements(body, scope))?;
            Some((holds, flow))
        })
    }

    /// Makes a function of a loop over `iterators` whose first range has bounds known only at run
    /// time, and assigns its outputs; false if the bounds are known.
    pub(crate) fn for_as_function(
        &mut self,
        iterators: &[Loop],
        body: &[Statement],
        scope: Scope,
    ) -> Option<bool> {
        let Some((first, rest)) = iterators.split_first() else { return Some(false) };
        let Some(range) = self.open_range(first, scope)? else { return Some(false) };
        let span = first.range.as_ref().map_or(first.name.span, |r| r.span);
        // The iterator is computed from the number of the iteration: a sum of steps would
        // accumulate rounding errors.
        let counter = crate::base::name::name("$iteration");
        let mut names: FastSet<Name> = std::iter::once(counter).collect();
        super::implicit_ranges::assigned(body, &mut names);
        let zero = Value::Scalar(self.graph.integer(0));
        let at = self.frames.visible().len();
        let done = self.with_local(counter, zero, |cx| {
            cx.loop_as_function(&names, span, |cx| {
                let iteration = cx.frames.visible()[at].1.scalar()?;
                let holds = cx.is_within(iteration, &range);
                let passed = cx.graph.binary(Binary::Mul, iteration, range.step);
                let value = cx.graph.binary(Binary::Add, range.start, passed);
                let flow = cx.with_local(first.name.name, Value::Scalar(value), |cx| {
                    cx.under(holds, |cx| cx.run_for(rest, body, scope))
                });
                let one = cx.graph.integer(1);
                let next = cx.graph.binary(Binary::Add, iteration, one);
                cx.frames.visible_mut()[at].1 = Value::Scalar(next);
                Some((holds, flow?))
            })
        });
        done.map(|()| true)
    }

    /// A symbol for the values of an iterator whose range is known only at run time.
    pub(crate) fn unknown_iterator(
        &mut self,
        iterator: &Loop,
        scope: Scope,
    ) -> Option<Option<Value>> {
        let Some(range) = self.open_range(iterator, scope)? else { return Some(None) };
        let ty = self.graph.common_type(range.start, range.step);
        let any = symbol(self.loops.symbols);
        self.loops.symbols += 1;
        Some(Some(Value::Scalar(self.graph.var(any, ty))))
    }

    /// The bounds of a range if they are known only at run time.
    fn open_range(&mut self, iterator: &Loop, scope: Scope) -> Option<Option<Range>> {
        let Some(range) = &iterator.range else { return Some(None) };
        let ExprKind::Range { start, step, stop } = &range.kind else { return Some(None) };
        let start = self.evaluate(start, scope)?.scalar();
        let stop = self.evaluate(stop, scope)?.scalar();
        let step = match step {
            Some(step) => self.evaluate(step, scope)?.scalar(),
            None => Some(self.graph.integer(1)),
        };
        let (Some(start), Some(step), Some(stop)) = (start, step, stop) else { return Some(None) };
        let is_number = |e: &ExprId| matches!(self.graph.ty(*e), Type::Integer | Type::Real);
        if ![start, step, stop].iter().all(is_number) {
            return Some(None);
        }
        let parts = self.graph.postorder([start, step, stop]);
        let known = parts.into_iter().all(|n| self.may_be_known(n, true));
        Some((!known).then_some(Range { start, step, stop }))
    }

    /// Whether there is an iteration of this number, counted from 0 (as many as a vector of the
    /// range has elements).
    fn is_within(&mut self, iteration: ExprId, range: &Range) -> ExprId {
        let way = self.graph.sub(range.stop, range.start);
        let whole = [way, range.step].into_iter().all(|e| self.graph.ty(e) == Type::Integer);
        let mut last = self.graph.div(way, range.step);
        if !whole {
            let margin = self.graph.real(super::collection::MARGIN);
            last = self.graph.add(last, margin);
        }
        self.graph.binary(Binary::LessEqual, iteration, last)
    }

    /// Makes a function of a loop that changes locals of these names, and assigns its outputs.
    /// `run` executes one iteration and returns its condition and how it ends.
    fn loop_as_function(
        &mut self,
        names: &FastSet<Name>,
        span: Span,
        run: impl FnOnce(&mut Self) -> Option<(ExprId, Flow)>,
    ) -> Option<()> {
        let before: Vec<(Name, Value)> = self.frames.visible().to_vec();
        let changed: Vec<usize> =
            (0..before.len()).filter(|k| names.contains(&before[*k].0)).collect();
        let mut iteration = Iteration::default();
        for &k in &changed {
            let (graph, counter) = (&mut self.class_graph.graph, &mut self.loops.symbols);
            let symbolic = before[k].1.each_scalar(&mut |e| iteration.symbol(graph, counter, e));
            self.frames.visible_mut()[k].1 = symbolic;
        }
        // In a model: the variables that its algorithm assigns.
        let outside = match self.frames.in_function() {
            true => FastMap::default(),
            false => self.assigned.clone(),
        };
        let mut variables: Vec<VarId> = outside.keys().copied().collect();
        variables.sort_unstable();
        for v in &variables {
            let (graph, counter) = (&mut self.class_graph.graph, &mut self.loops.symbols);
            let symbolic = iteration.symbol(graph, counter, outside[v]);
            self.assigned.insert(*v, symbolic);
        }
        let left = std::mem::take(&mut self.exits);
        let reached = self.neither(left.broken, left.returned);
        // An assertion about an iteration has no place outside of the loop.
        let (run, asserts) = self.collect_assertions(|cx| cx.under(reached, run));
        let (condition, flow) = run?;
        iteration.asserts = asserts;
        iteration.condition = Some(condition);
        for &k in &changed {
            self.frames.visible()[k].1.for_each_scalar(&mut |e| iteration.next_values.push(e));
        }
        iteration.next_values.extend(variables.iter().map(|v| self.assigned[v]));
        if iteration.next_values.len() != iteration.symbols.len() {
            self.unsupported(span, Construct::GrowingArray);
            return None;
        }
        if !self.frames.in_function() && self.assigned.len() != variables.len() {
            self.unsupported(span, Construct::FirstAssignmentInLoop);
            return None;
        }
        let (condition, returns) = self.until_left(condition, flow, left, &mut iteration);
        let results = self.called_loop(iteration, condition, span);
        let mut next = results.iter().copied();
        for &k in &changed {
            let result = before[k].1.each_scalar(&mut |e| next.next().unwrap_or(e));
            self.frames.visible_mut()[k].1 = result;
        }
        for (v, e) in variables.into_iter().zip(next) {
            self.assigned.insert(v, e);
        }
        self.exits.broken = left.broken;
        self.exits.returned = if returns { results.last().copied() } else { left.returned };
        Some(())
    }

    /// A loop that contains `break` or `return`, or follows an exit, continues while a symbol
    /// holds; a last symbol records whether it was left by `return`. Takes the exits `before` it;
    /// returns the condition for another iteration, and whether there is that last symbol.
    fn until_left(
        &mut self,
        condition: ExprId,
        flow: Flow,
        before: Exits,
        iteration: &mut Iteration,
    ) -> (ExprId, bool) {
        let sure = self.graph.boolean(true);
        let now = |kind: Flow, part: Option<ExprId>| if flow == kind { Some(sure) } else { part };
        let broken = now(Flow::Break, self.exits.broken);
        let returned = now(Flow::Return, self.exits.returned);
        if broken.or(returned).or(before.broken).or(before.returned).is_none() {
            return (condition, false);
        }
        let goes_on = self.neither(before.broken, before.returned);
        let next = self.neither(broken, returned);
        let (graph, counter) = (&mut self.class_graph.graph, &mut self.loops.symbols);
        let goes_on = iteration.symbol(graph, counter, goes_on);
        iteration.next_values.push(next);
        let condition = graph.and(goes_on, condition);
        if let Some(returned) = returned {
            let never = graph.boolean(false);
            iteration.symbol(graph, counter, before.returned.unwrap_or(never));
            iteration.next_values.push(returned);
        }
        (condition, returned.is_some())
    }

    /// `not (a or b)`, of conditions that are false where there is none.
    pub(crate) fn neither(&mut self, a: Option<ExprId>, b: Option<ExprId>) -> ExprId {
        let mut result = self.graph.boolean(true);
        for c in [a, b].into_iter().flatten() {
            let not_c = self.graph.not(c);
            result = self.graph.and(result, not_c);
        }
        result
    }

    /// Calls a loop as a function: the final values of its symbols.
    fn called_loop(&mut self, iteration: Iteration, condition: ExprId, span: Span) -> Vec<ExprId> {
        // An Integer may become a Real in the loop.
        let both = iteration.initial.iter().zip(&iteration.next_values);
        let types: Vec<Type> = both.map(|(a, b)| self.graph.common_type(*a, *b)).collect();
        let name = match self.recursions.calls.last() {
            Some(call) => self.classes[call.class].full_name.to_string(),
            None => "an algorithm".to_string(),
        };
        let (function, captured) = function(&mut self.graph, name, span, &iteration, condition);
        let key = (span, function.inputs.len(), function.values());
        let next = FunctionId::from_usize(self.loops.functions.len());
        let id = *self.loops.by_body.entry(key).or_insert(next);
        if id == next {
            self.loops.functions.push(function);
        }
        let mut arguments = iteration.initial;
        arguments.extend(captured);
        let args = self.graph.intern_list(&arguments);
        let calls = types.into_iter().enumerate().map(|(output, ty)| {
            let call = Node::Call { function: id, output: output as u32, args };
            self.graph.intern(call, ty)
        });
        calls.collect()
    }
}

/// Nodes that an assertion in a loop may compute in addition to the iteration. One that needs more,
/// such as a value of one branch alone, would slow each iteration down: it is dropped.
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

/// The function of a loop over symbols, and the expressions it captures.
fn function(
    graph: &mut Graph,
    name: String,
    span: Span,
    Iteration { symbols, next_values, asserts, condition: continues, .. }: &Iteration,
    condition: ExprId,
) -> (Function, Vec<ExprId>) {
    let mut asserts: Vec<(Assert, Span)> =
        asserts.iter().filter_map(Asserted::in_function).collect();
    // In an iteration the condition holds.
    let mut rewriter = Rewriter::new();
    for (assert, _) in &mut asserts {
        assert.condition = rewriter.apply(graph, assert.condition, &mut |g, n| {
            (Some(n) == *continues).then(|| g.boolean(true))
        });
    }
    let mut roots: Vec<ExprId> =
        std::iter::once(condition).chain(next_values.iter().copied()).collect();
    let always = always(graph, &roots);
    asserts.retain(|(a, _)| {
        let more = graph.postorder([a.condition]).into_iter().filter(|n| !always.contains(n));
        let is_sure = graph.as_const(a.condition) == Some(Const::Boolean(true));
        !is_sure && costs_at_most(graph, more, MOST_ASSERTED)
    });
    let mut locals: FastMap<VarId, u32> = FastMap::default();
    for (k, v) in symbols.iter().enumerate() {
        locals.insert(*v, k as u32);
    }
    // Expressions that read a symbol are computed inside, and so are calls in branches that may not
    // be taken; the largest others become arguments.
    let mut inside: FastSet<ExprId> = FastSet::default();
    let mut calls: FastSet<ExprId> = FastSet::default();
    roots.extend(asserts.iter().flat_map(|(a, _)| [a.condition, a.message]));
    for n in graph.postorder(roots.iter().copied()) {
        let mut reads = matches!(graph.node(n), Node::Var(v) if locals.contains_key(&v));
        let mut has_call = matches!(graph.node(n), Node::Call { .. });
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
    asserts.retain_mut(|(a, _)| {
        let mut all = outside(graph, [a.condition], &inside).into_iter();
        if !all.all(|n| read.contains(&n) || is_cheap(graph, n)) {
            return false;
        }
        if !outside(graph, [a.message], &inside).is_subset(&read) {
            a.message = graph.string("its condition is false");
        }
        true
    });
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
    let mut iteration: Vec<Step> = Vec::new();
    for (a, span) in asserts {
        let (condition, message) = (local(graph, a.condition), local(graph, a.message));
        iteration.push(Step::Assert(Assert { condition, message, ..a }, span));
    }
    let (count, inputs) = (symbols.len(), symbols.len() + captured.len());
    let mut names: Vec<String> = (1..=inputs).map(|k| format!("x{k}")).collect();
    // All variables are assigned at once: new values are first stored separately.
    names.extend((1..=count).map(|k| format!("next{k}")));
    let id = |k: usize| LocalId::from_usize(k);
    iteration.extend(next_values.iter().enumerate().map(|(k, e)| Step::Assign(id(inputs + k), *e)));
    for (k, e) in next_values.iter().enumerate().take(count) {
        let ty = graph.ty(*e);
        let next = graph.var(VarId((inputs + k) as u32), ty);
        iteration.push(Step::Assign(id(k), next));
    }
    let function = Function {
        name,
        span,
        inputs: (0..inputs).map(id).collect(),
        outputs: (0..count).map(id).collect(),
        locals: names.into_iter().collect(),
        body: vec![Step::While(condition, iteration)],
    };
    (function, captured)
}
