//! Calls of functions. The body of a function is executed once, on symbols, for each specialization: the
//! class, the sizes and types of its arguments, and those that are known. Every call with such arguments is
//! then made of that one body: [`inline`](super::inline) decides whether it is substituted or called.
//!
//! Some calls cannot be made that way. They are executed on their own arguments, for one of the reasons
//! [`WhyExecuted`].

use std::rc::Rc;

use super::Evaluator;
use super::assertion::Asserted;
use super::function::Components;
use super::mode::Mode;
use super::random_draw::RandomDraws;
use super::runtime_loop::symbol;
use super::value::Value;
use crate::base::index::{FastMap, FastSet, Id};
use crate::base::name::Name;
use crate::base::source::Span;
use crate::ir::expr::{ExprId, FIRST_SYMBOL, FunctionId, Graph, Node, Type};
use crate::ir::instance::ClassId;
use crate::symbolic::rewrite::Rewriter;

/// Why a call is executed on its own arguments.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum WhyExecuted {
    /// A value, or a size, is asked for before the model runs.
    BeforeSimulation,
    /// All arguments are known: so is the result.
    Known,
    /// An external function is one operator already.
    External,
    /// An argument that parameters determine, such as an Integer, may decide sizes, branches and loops.
    Structural,
    /// The function calls itself: how deep it goes may depend on its arguments.
    Recursive,
    /// Each call does something of its own, such as drawing a random number.
    Impure,
    /// An error, or a warning, that need not occur with the arguments of each call.
    Diagnosed,
}

/// What distinguishes the arguments of two specializations.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
enum Token {
    /// Left to its default.
    Default,
    Array(Vec<usize>),
    Record(Option<ClassId>, Vec<Name>),
    Tuple(usize),
    Function(ClassId, Vec<Name>),
    /// A literal.
    Known(ExprId),
    /// Any expression of this type.
    Open(Type),
}

/// The specializations that were made.
#[derive(Default)]
pub(crate) struct Specializations {
    of: FastMap<(ClassId, Vec<Token>), Result<Rc<Specialization>, WhyExecuted>>,
    /// Functions that were found to call themselves.
    recursive: FastSet<ClassId>,
    /// Those that are functions of the flat model, by their first symbol; `None` for those that cannot be.
    pub(super) flat: FastMap<u32, Option<FlatFunction>>,
}

/// The function of the flat model that a specialization became.
#[derive(Clone)]
pub(super) struct FlatFunction {
    pub(super) id: FunctionId,
    /// The types of its outputs.
    pub(super) types: Vec<Type>,
}

/// A function whose body was executed on symbols.
pub(crate) struct Specialization {
    pub(super) class: ClassId,
    /// The symbol for the condition under which a call is active, then those of the inputs.
    pub(super) symbols: Vec<ExprId>,
    /// The number of the first symbol.
    pub(super) first: u32,
    /// The outputs.
    pub(super) value: Value,
    /// The assertions of the body.
    pub(super) asserts: Vec<Asserted>,
    /// Whether a constant with a unit was read as a plain number.
    unitless_literal: bool,
    /// The number of nodes that the body adds to a model.
    pub(super) size: usize,
    /// Whether the body calls functions of the flat model.
    has_calls: bool,
    /// The number of functions of the flat model when it was made.
    functions: FunctionId,
}

/// What a call may do besides computing a value.
#[derive(Clone, PartialEq)]
struct Effects {
    draws: RandomDraws,
    synthetic: usize,
    lines: usize,
    objects: usize,
}

impl Evaluator<'_> {
    /// Calls a function that is not recursive as far as is known.
    pub(super) fn call_specialized(
        &mut self,
        class: ClassId,
        components: &Components,
        mut given: Vec<Option<Value>>,
        span: Span,
    ) -> Option<Value> {
        self.with_numbers_of_tables(&mut given);
        match self.specialization(class, components, &given, span) {
            Ok(body) => self.call_of(&body, components, &given),
            Err(WhyExecuted::Diagnosed) => self.run_or_fold(class, components, given, span),
            Err(_) => self.run_function(class, components, given, span),
        }
    }

    /// Runs a function on its arguments. If that fails, but the arguments are known before the model runs, it is run
    /// on their values: eigenvalues are those of numbers. The parameters that they read are then fixed.
    fn run_or_fold(
        &mut self,
        class: ClassId,
        components: &Components,
        given: Vec<Option<Value>>,
        span: Span,
    ) -> Option<Value> {
        let mut all = Vec::new();
        given.iter().flatten().for_each(|value| value.for_each_scalar(&mut |e| all.push(e)));
        if !all.iter().all(|e| self.is_parameter_expression(*e)) {
            return self.run_function(class, components, given, span);
        }
        let (value, problems) =
            self.collect_problems(|cx| cx.run_function(class, components, given.clone(), span));
        if value.is_none()
            && let Some(known) = self.values_of_arguments(&given)
        {
            return self.run_function(class, components, known, span);
        }
        self.problems.extend(problems);
        value
    }

    /// The arguments of a call, as far as they are given, as numbers; `None` if one is not known before the model runs.
    fn values_of_arguments(&mut self, given: &[Option<Value>]) -> Option<Vec<Option<Value>>> {
        let mut is_known = true;
        let mut number = |cx: &mut Self, value: &Value| {
            value.each_scalar(&mut |e| match cx.parameter_expression(e, true) {
                Some(known) => cx.graph.constant(known),
                None => {
                    is_known = false;
                    e
                }
            })
        };
        let values = given.iter().map(|value| value.as_ref().map(|value| number(self, value)));
        let values = values.collect();
        is_known.then_some(values)
    }

    /// The specialization for some arguments, which is made if it is the first one.
    fn specialization(
        &mut self,
        class: ClassId,
        components: &Components,
        given: &[Option<Value>],
        span: Span,
    ) -> Result<Rc<Specialization>, WhyExecuted> {
        if self.mode.is_before_simulation() {
            return Err(WhyExecuted::BeforeSimulation);
        }
        if self.specializations.recursive.contains(&class)
            || self.recursions.calls.iter().any(|c| c.class == class)
        {
            return Err(WhyExecuted::Recursive);
        }
        if self.table(class).external.is_some() {
            return Err(WhyExecuted::External);
        }
        let mut open = Vec::new();
        let mut of_given = Vec::new();
        for value in given {
            match value {
                Some(value) => tokens(&self.graph, value, &mut of_given, &mut open),
                None => of_given.push(Token::Default),
            }
        }
        if open.is_empty() {
            return Err(WhyExecuted::Known);
        }
        let is_real = |e: &ExprId| self.graph.ty(*e) == Type::Real;
        if open.iter().any(|e| !is_real(e) && self.is_parameter_expression(*e)) {
            return Err(WhyExecuted::Structural);
        }
        let key = (class, of_given);
        let known = match self.specializations.of.get(&key) {
            Some(known) => known.clone(),
            None => {
                let made = self.specialize(class, components, given, &open, span).map(Rc::new);
                self.specializations.of.insert(key, made.clone());
                made
            }
        };
        // Where parameters determine the trip count of a loop, it is unrolled.
        if let Ok(body) = &known
            && body.has_calls
            && open.iter().any(|e| self.is_parameter_expression(*e))
        {
            return Err(WhyExecuted::Structural);
        }
        known
    }

    /// Whether a value may be found before the model runs.
    fn is_parameter_expression(&self, e: ExprId) -> bool {
        self.may_be_known(self.first_leaf(e), true)
            && self.graph.all([e], |n, _| self.may_be_known(n, true))
    }

    /// Executes the body of a function on symbols for these scalars of its arguments.
    fn specialize(
        &mut self,
        class: ClassId,
        components: &Components,
        given: &[Option<Value>],
        open: &[ExprId],
        span: Span,
    ) -> Result<Specialization, WhyExecuted> {
        let first = self.loops.symbols;
        self.loops.symbols += open.len() as u32 + 1;
        let graph = &mut self.class_graph.graph;
        let mut symbols = vec![graph.var(symbol(first), Type::Boolean)];
        for (k, e) in (1..).zip(open) {
            let ty = graph.ty(*e);
            symbols.push(graph.var(symbol(first + k), ty));
        }
        let mut next = symbols[1..].iter();
        let mut on_symbol = |value: &Value| {
            value.each_scalar(&mut |e| match graph.as_const(e) {
                Some(_) => e,
                None => next.next().copied().unwrap_or(e),
            })
        };
        let inputs: Vec<Option<Value>> =
            given.iter().map(|value| value.as_ref().map(&mut on_symbol)).collect();

        let functions = FunctionId::from_usize(self.loops.functions.len());
        let before = self.effects();
        let unitless = std::mem::take(&mut self.units.unitless_literal);
        let active = symbols[0];
        let run = |cx: &mut Self| {
            // How the caller gets here is no matter of the body, which other calls share.
            cx.with_exits_closed(|cx| {
                cx.unconditionally(|cx| {
                    cx.under(active, |cx| cx.execute(class, components, inputs, false, span))
                })
            })
        };
        let ((value, asserts), problems) = self
            .collect_problems(|cx| cx.collect_assertions(|cx| cx.with_mode(Mode::default(), run)));
        let unitless_literal = std::mem::replace(&mut self.units.unitless_literal, unitless);
        let (value, why) = match value {
            _ if self.recursions.is_unwinding() => (None, WhyExecuted::Recursive),
            _ if self.effects() != before => (None, WhyExecuted::Impure),
            value => (value.filter(|_| problems.is_empty()), WhyExecuted::Diagnosed),
        };
        let Some(value) = value else {
            self.forget_specialization(class, functions, before, why);
            return Err(why);
        };
        let mut roots = Vec::new();
        value.for_each_scalar(&mut |e| roots.push(e));
        roots.extend(asserts.iter().flat_map(|a| [a.condition, a.message]));
        let below = self.graph.postorder(roots);
        let has_calls = below.iter().any(|n| matches!(self.graph.node(*n), Node::Call { .. }));
        Ok(Specialization {
            class,
            symbols,
            first,
            value,
            asserts,
            unitless_literal,
            size: below.len(),
            has_calls,
            functions: FunctionId::from_usize(self.loops.functions.len()),
        })
    }

    fn effects(&self) -> Effects {
        Effects {
            draws: self.random_draws.clone(),
            synthetic: self.history.synthetic.len(),
            lines: self.history.lines.len(),
            objects: self.objects.len(),
        }
    }

    /// Takes back everything that the body of a function has done.
    fn forget_specialization(
        &mut self,
        class: ClassId,
        functions: FunctionId,
        before: Effects,
        why: WhyExecuted,
    ) {
        self.random_draws = before.draws;
        self.history.synthetic.truncate(before.synthetic);
        self.history.lines.truncate(before.lines);
        self.objects.truncate(before.objects);
        if why == WhyExecuted::Recursive {
            self.recursions.stop_unwinding();
            self.specializations.recursive.insert(class);
        }
        if self.loops.functions.len() > functions.idx() {
            self.forget(functions);
            let made = &mut self.specializations;
            made.flat.retain(|_, f| f.as_ref().is_none_or(|f| f.id < functions));
            let is_kept = |s: &Specialization| !s.has_calls || s.functions <= functions;
            made.of.retain(|_, s| s.as_ref().map_or(true, |s| is_kept(s)));
        }
    }

    /// The results of a call with these arguments.
    fn call_of(
        &mut self,
        body: &Specialization,
        components: &Components,
        given: &[Option<Value>],
    ) -> Option<Value> {
        let outermost = !self.frames.in_function();
        let left = self.exits;
        let reached = self.none_of(left.all());
        self.units.unitless_literal |= body.unitless_literal;
        let mut arguments = Vec::with_capacity(body.symbols.len());
        for value in given.iter().flatten() {
            value.for_each_scalar(&mut |e| {
                if self.graph.as_const(e).is_none() {
                    arguments.push(e);
                }
            });
        }
        let events = if outermost { self.events_of_arguments(given) } else { FastSet::default() };
        self.with_exits_closed(|cx| {
            cx.under(reached, |cx| {
                let called = match cx.why_inlined(body, components, &arguments) {
                    None => cx.call_flat(body, &arguments),
                    Some(_) => None,
                };
                let mut made = match called {
                    Some(called) => called,
                    None => cx.inline(body, &arguments)?,
                };
                if outermost {
                    made = cx.closed(&made, &events);
                }
                Some(made)
            })
        })
    }

    /// Substitutes arguments for the symbols of a body.
    fn inline(&mut self, body: &Specialization, arguments: &[ExprId]) -> Option<Value> {
        let active = match body.has_calls {
            true => self.active_condition(),
            false => self.graph.boolean(true),
        };
        let all: Vec<ExprId> = std::iter::once(active).chain(arguments.iter().copied()).collect();
        let mut with_arguments = body.formula(&all);
        for a in &body.asserts {
            let graph = &mut self.class_graph.graph;
            let condition = with_arguments(graph, a.bare);
            let message = with_arguments(graph, a.message);
            // The first one says that the call is not active, which is known here.
            let unless = a.unless[1..].iter().map(|e| with_arguments(graph, *e)).collect();
            self.assert_unless(condition, unless, message, a.level, a.span)?;
        }
        let graph = &mut self.class_graph.graph;
        Some(body.value.each_scalar(&mut |e| with_arguments(graph, e)))
    }
}

impl Specialization {
    /// Substitutes the condition under which a call is active, and its arguments, for the symbols of the body.
    pub(super) fn formula<'a>(
        &self,
        arguments: &'a [ExprId],
    ) -> impl FnMut(&mut Graph, ExprId) -> ExprId + use<'a> {
        let first = FIRST_SYMBOL + self.first;
        let mut rewriter = Rewriter::new();
        move |graph, e| {
            rewriter.apply(graph, e, &mut |graph, n| {
                let Node::Var(v) = graph.node(n) else { return None };
                arguments.get(v.0.checked_sub(first)? as usize).copied()
            })
        }
    }
}

/// Describes a value, and lists its scalars that are no literals.
fn tokens(graph: &Graph, value: &Value, out: &mut Vec<Token>, open: &mut Vec<ExprId>) {
    match value {
        Value::Scalar(e) => match graph.as_const(*e) {
            Some(_) => out.push(Token::Known(*e)),
            None => {
                out.push(Token::Open(graph.ty(*e)));
                open.push(*e);
            }
        },
        Value::Array(a) => {
            out.push(Token::Array(a.dims.clone()));
            a.elements.iter().for_each(|v| tokens(graph, v, out, open));
        }
        Value::Record(r) => {
            out.push(Token::Record(r.class, r.fields.iter().map(|f| f.0).collect()));
            r.fields.iter().for_each(|(_, v)| tokens(graph, v, out, open));
        }
        Value::Tuple(all) => {
            out.push(Token::Tuple(all.len()));
            all.iter().for_each(|v| tokens(graph, v, out, open));
        }
        Value::Function(p) => {
            out.push(Token::Function(p.class, p.bound.iter().map(|(n, _)| n.name).collect()));
            p.bound.iter().for_each(|(_, v)| tokens(graph, v, out, open));
        }
    }
}
