//! Loops whose trip count is known only at run time: they become functions of the flat model.
//!
//! The variables that a loop changes are the locals of such a function. Its body is executed once
//! on them as symbols; their final values are the assignments of one iteration. Anything else that
//! the loop reads is passed as an argument.

use super::Evaluator;
use super::algorithm::{Exits, Flow};
use super::loop_function::{self, Iteration, Purpose};
use super::value::Value;
use crate::base::index::{FastMap, FastSet, Id};
use crate::base::name::Name;
use crate::base::source::Span;
use crate::classes::unsupported::Construct;
use crate::ir::ast::{Expr, ExprKind, Iterator as Loop, Statement};
use crate::ir::expr::{Binary, ExprId, FIRST_SYMBOL, FunctionId, ListId, Node, Type, VarId};
use crate::ir::flat::{Assert, AssertionLevel, Function};
use crate::ir::instance::Scope;

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

/// A range whose bounds are known only at run time.
pub(super) struct Range {
    pub(super) start: ExprId,
    pub(super) step: ExprId,
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
        let at = self.frames.visible().len();
        // Named by its position: a loop around this one has another counter, which this loop leaves as it is.
        let counter = crate::base::name::name(&format!("$iteration{at}"));
        let mut names: FastSet<Name> = std::iter::once(counter).collect();
        super::implicit_ranges::assigned(body, &mut names);
        let zero = Value::Scalar(self.graph.integer(0));
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
    pub(super) fn open_range(&mut self, iterator: &Loop, scope: Scope) -> Option<Option<Range>> {
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
    pub(super) fn is_within(&mut self, iteration: ExprId, range: &Range) -> ExprId {
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
    pub(super) fn loop_as_function(
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
        let mut symbolic = Vec::with_capacity(variables.len());
        for v in &variables {
            let (graph, counter) = (&mut self.class_graph.graph, &mut self.loops.symbols);
            symbolic.push(iteration.symbol(graph, counter, outside[v]));
        }
        self.assigned.extend(variables.iter().copied().zip(symbolic.iter().copied()));
        before.iter().for_each(|(_, v)| v.for_each_scalar(&mut |e| iteration.computed.push(e)));
        iteration.computed.extend(outside.values());
        let left = std::mem::take(&mut self.exits);
        let reached = self.none_of(left.all());
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
        // A variable that the loop does not assign keeps its value. As a result of the loop it would seem to change with
        // whatever the loop reads, also between events.
        let is_kept: Vec<bool> = variables
            .iter()
            .zip(&symbolic)
            .map(|(v, symbol)| self.assigned[v] == *symbol)
            .collect();
        let (condition, returns) = self.until_left(condition, flow, left, &mut iteration);
        let results = self.called_loop(iteration, condition, span);
        let mut next = results.iter().copied();
        for &k in &changed {
            let result = before[k].1.each_scalar(&mut |e| next.next().unwrap_or(e));
            self.frames.visible_mut()[k].1 = result;
        }
        for ((v, e), is_kept) in variables.into_iter().zip(next).zip(is_kept) {
            self.assigned.insert(v, if is_kept { outside[&v] } else { e });
        }
        let returned = if returns { results.last().copied() } else { left.returned };
        self.exits = Exits { returned, ..left };
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
        if broken.or(returned).is_none() && before == Exits::default() {
            return (condition, false);
        }
        let goes_on = self.none_of(before.all());
        let next = self.none_of(broken.into_iter().chain(returned));
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

    /// True if none of these conditions is.
    pub(crate) fn none_of(&mut self, conditions: impl Iterator<Item = ExprId>) -> ExprId {
        let mut result = self.graph.boolean(true);
        for c in conditions {
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
        let asserts = loop_function::assertions(&mut self.graph, &iteration);
        let place = (name, span);
        let made = loop_function::function(
            &mut self.graph,
            place.clone(),
            &iteration,
            condition,
            asserts,
            Purpose::Values,
        );
        if !made.unchecked.is_empty() {
            self.check_by_function(place, &iteration, condition, made.unchecked);
        }
        let (id, args) = self.call_of_loop(made.function, &iteration, made.captured);
        let calls = types.into_iter().enumerate().map(|(output, ty)| {
            let call = Node::Call { function: id, output: output as u32, args };
            self.graph.intern(call, ty)
        });
        calls.collect()
    }

    /// Leaves assertions of a loop to a function that goes through it once more. They become assertions of what
    /// contains the loop: unlike the arguments of the loop, what they read does not matter to the equations.
    fn check_by_function(
        &mut self,
        place: (String, Span),
        iteration: &Iteration,
        condition: ExprId,
        asserts: Vec<(Assert, Span)>,
    ) {
        let checks: Vec<(AssertionLevel, Span)> =
            asserts.iter().map(|(a, span)| (a.level, *span)).collect();
        let made = loop_function::function(
            &mut self.graph,
            place,
            iteration,
            condition,
            asserts,
            Purpose::Checks,
        );
        let (function, args) = self.call_of_loop(made.function, iteration, made.captured);
        for (k, (level, span)) in (0..).zip(checks) {
            let holds = Node::Call { function, output: 2 * k, args };
            let holds = self.graph.intern(holds, Type::Boolean);
            let message = Node::Call { function, output: 2 * k + 1, args };
            let message = self.graph.intern(message, Type::String);
            // How the body of the loop was left does not matter to what follows the loop.
            self.with_exits_closed(|cx| cx.assert_now_or_later(holds, message, level, span));
        }
    }

    /// The function of a loop, which is shared with equal ones, and its arguments.
    fn call_of_loop(
        &mut self,
        function: Function,
        iteration: &Iteration,
        captured: Vec<ExprId>,
    ) -> (FunctionId, ListId) {
        let key = (function.span, function.inputs.len(), function.values());
        let next = FunctionId::from_usize(self.loops.functions.len());
        let id = *self.loops.by_body.entry(key).or_insert(next);
        if id == next {
            self.loops.functions.push(function);
        }
        let mut arguments = iteration.initial.clone();
        arguments.extend(captured);
        (id, self.graph.intern_list(&arguments))
    }
}
