//! Recursive functions whose depth is known only at run time: they become functions of the flat
//! model.
//!
//! A call is first executed on its arguments like any other. If no condition ends the recursion,
//! all calls are unwound up to the outermost one; its body is executed once on symbols, and its
//! recursive calls become calls of the flat model's function. Known arguments stay known until a
//! recursive call passes another value, so that sizes may depend on them.
//!
//! The first argument of each call is the condition under which it is active: branches become `if`
//! expressions whose parts may be computed anywhere, and the end of the recursion must not depend
//! on where that is.

use super::algorithm::Exits;
use super::assertion::Asserted;
use super::cause::call::CallCause;
use super::frame::FrameKind;
use super::function::Components;
use super::runtime_loop::symbol;
use super::value::Value;
use super::{Evaluator, MAX_DEPTH};
use crate::base::diag::{Diagnostic, Problems, Severity};
use crate::base::index::{FastMap, FastSet, Id};
use crate::base::name::Name;
use crate::base::source::Span;
use crate::ir::ast::Causality;
use crate::ir::expr::{Const, ExprId, FunctionId, Graph, Node, Type, VarId};
use crate::ir::flat::{Assert, Function, LocalId, Statement};
use crate::ir::instance::ClassId;
use crate::symbolic::rewrite::Rewriter;

/// So many calls of a function in itself are made part of the model though nothing here decides whether
/// there are more.
const MOST_OPEN: usize = 4;

/// Number of calls that are executed for one call of the model.
const MAX_CALLS: usize = 300_000;

/// Number of functions that may call each other in a row without any calling itself.
const MAX_CHAIN: usize = 1000;

/// An open call of a function.
pub(crate) struct Call {
    pub(super) class: ClassId,
    /// Whether it is certain that its caller makes it.
    certain: bool,
    /// The number of conditions around it.
    path: usize,
}

/// How far calls are left.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Unwinding {
    /// Up to the outermost one of this function.
    To(ClassId),
    /// All: they are deeper than any that end.
    Out,
}

/// State of recursive functions.
#[derive(Default)]
pub(crate) struct Recursions {
    /// Open calls, the innermost last.
    pub(super) calls: Vec<Call>,
    /// Number of calls that were executed for the outermost open one.
    executed: usize,
    unwinding: Option<Unwinding>,
    /// Those whose outermost calls led to more than are executed.
    exhausted: FastSet<ClassId>,
    /// Those that are functions of the flat model, by class.
    made: FastMap<ClassId, Vec<Recursive>>,
    /// Those that cannot be, and why.
    refused: FastMap<ClassId, String>,
    /// Scalars of the arguments that turned out not to be the same in all calls, by function and number.
    widened: FastSet<(ClassId, usize)>,
}

/// A function of the flat model that calls itself.
#[derive(Clone)]
struct Recursive {
    id: FunctionId,
    /// Its inputs: symbols, and values that are the same in all calls.
    inputs: Vec<Value>,
    symbols: FastSet<ExprId>,
    /// The sizes and types of its outputs.
    results: Value,
    /// Its body is being read.
    open: bool,
}

/// Whether a call is one of a function of the flat model.
enum Fit {
    Fits(Vec<ExprId>),
    /// These scalars of the arguments are other ones.
    Others(Vec<usize>),
    /// The arguments have other sizes.
    Differs,
}

impl Recursions {
    /// Whether calls are being left.
    pub(super) fn is_unwinding(&self) -> bool {
        self.unwinding.is_some()
    }

    /// Whether a recursive function is being made.
    pub(super) fn is_being_made(&self) -> bool {
        self.made.values().flatten().any(|f| f.open)
    }

    /// Goes on after calls were left.
    pub(super) fn stop_unwinding(&mut self) {
        self.unwinding = None;
    }
}

impl Evaluator<'_> {
    /// A call of a function that is part of the flat model already, or that must become one; `None` for any
    /// other. The inner `None` is one that is left.
    pub(super) fn recursive(
        &mut self,
        class: ClassId,
        components: &Components,
        given: &[Option<Value>],
        span: Span,
    ) -> Option<Option<Value>> {
        if self.recursions.unwinding.is_some() {
            return Some(None);
        }
        if !self.mode.fold && self.recursions.made.contains_key(&class) {
            let inputs = self.all_inputs(class, components, given);
            let Some(inputs) = inputs else { return Some(None) };
            for k in 0..self.recursions.made[&class].len() {
                let function = self.recursions.made[&class][k].clone();
                match self.fit(&function, &inputs) {
                    Fit::Fits(arguments) => return Some(Some(self.called(&function, arguments))),
                    Fit::Others(which) if function.open => {
                        let widened = which.into_iter().map(|k| (class, k));
                        self.recursions.widened.extend(widened);
                        self.recursions.unwinding = Some(Unwinding::To(class));
                        return Some(None);
                    }
                    Fit::Differs if function.open => {
                        return Some(
                            self.refuse(class, "it calls itself with arguments of other sizes"),
                        );
                    }
                    _ => {}
                }
            }
        }
        self.leave_what_is_deep(class, span).then_some(None)
    }

    /// Leaves all calls of a function that has called itself too often.
    fn leave_what_is_deep(&mut self, class: ClassId, span: Span) -> bool {
        let calls = &self.recursions.calls;
        let recursions = &self.recursions;
        let can_be_made = |c: &ClassId| !recursions.refused.contains_key(c);
        if !self.mode.fold && can_be_made(&class) {
            let mut own = calls.iter().enumerate().filter(|(_, c)| c.class == class);
            if let Some((second, _)) = own.nth(1) {
                let open = calls[second + 1..].iter().filter(|c| !c.certain).count();
                if open >= MOST_OPEN {
                    self.recursions.unwinding = Some(Unwinding::To(class));
                    return true;
                }
            }
        }
        if calls.len() < MAX_DEPTH {
            return false;
        }
        let mut met = FastSet::default();
        let recurring = calls.iter().map(|c| c.class).find(|c| !met.insert(*c));
        if recurring.is_none() && calls.len() < MAX_CHAIN {
            return false;
        }
        // Without a word that decides, calls never end, whatever the arguments.
        let can_end = |class: &ClassId| {
            let cycle: FastSet<ClassId> =
                calls.iter().skip_while(|c| c.class != *class).map(|c| c.class).collect();
            cycle.iter().any(|c| self.decides(*c))
        };
        let makes = |c: &ClassId| !self.mode.fold && can_be_made(c) && can_end(c);
        if let Some(recurring) = recurring.filter(makes) {
            self.recursions.unwinding = Some(Unwinding::To(recurring));
            return true;
        }
        let recurring = recurring.unwrap_or(class);
        let full_name = self.classes[recurring].full_name;
        let cause = CallCause::DeepRecursion { function: full_name, most: MAX_DEPTH };
        let mut diagnostic = Diagnostic::new(cause, span);
        if let Some(why) = self.recursions.refused.get(&recurring) {
            diagnostic = diagnostic.note(format!("its depth cannot be decided at run time: {why}"));
        }
        self.problems.push(diagnostic);
        self.recursions.unwinding = Some(Unwinding::Out);
        true
    }

    /// True if the text of a function holds anything by which it may end without calling itself.
    fn decides(&self, class: ClassId) -> bool {
        const WORDS: [&str; 7] = ["if", "while", "for", "return", "break", "and", "or"];
        let text = self.definition(class).and_then(|definition| self.sources.text(definition.span));
        let Some(text) = text else { return true };
        let mut words = text.split(|c: char| !c.is_alphanumeric() && c != '_');
        words.any(|word| WORDS.contains(&word))
    }

    /// Opens a call. `left` are the conditions under which the caller was left before it.
    pub(super) fn open_call(&mut self, class: ClassId, left: Exits) {
        if self.recursions.calls.is_empty() {
            self.recursions.executed = 0;
        }
        self.recursions.executed += 1;
        let path = self.assertions.conditions.len();
        let before = self.recursions.calls.last().map_or(path, |c| c.path);
        let certain = path == before && left == Exits::default();
        self.recursions.calls.push(Call { class, certain, path });
    }

    /// Reports a function whose outermost call leads to more calls than are executed here.
    pub(super) fn check_executed(&mut self, span: Span) -> Option<()> {
        let outermost = self.recursions.calls.first()?.class;
        let is_exhausted = self.recursions.exhausted.contains(&outermost);
        if self.recursions.executed <= MAX_CALLS && !is_exhausted {
            return Some(());
        }
        // All calls are left, and the function is not called again: each would take as long.
        if self.recursions.unwinding.is_some() || is_exhausted {
            return None;
        }
        self.recursions.exhausted.insert(outermost);
        let function = self.classes[outermost].full_name;
        self.report(CallCause::TooManyCalls { function, most: MAX_CALLS }, span);
        self.recursions.unwinding = Some(Unwinding::Out);
        None
    }

    /// Closes the innermost call.
    pub(super) fn close_call(&mut self) {
        self.recursions.calls.pop();
        let unwinding = &mut self.recursions.unwinding;
        if self.recursions.calls.is_empty() && *unwinding == Some(Unwinding::Out) {
            *unwinding = None;
        }
    }

    /// Result of an outermost call that was unwound because the recursion is too deep.
    pub(super) fn unwound_result(
        &mut self,
        class: ClassId,
        components: &Components,
        given: &[Option<Value>],
        span: Span,
    ) -> Option<Option<Value>> {
        if self.recursions.unwinding != Some(Unwinding::To(class))
            || self.recursions.calls.iter().any(|c| c.class == class)
        {
            return None;
        }
        self.recursions.unwinding = None;
        Some(self.call_as_flat_function(class, components, given, span))
    }

    /// Notes why a function can be none of the flat model, and leaves its calls.
    fn refuse<T>(&mut self, class: ClassId, why: &str) -> Option<T> {
        self.recursions.refused.insert(class, why.to_string());
        self.recursions.unwinding = Some(Unwinding::To(class));
        None
    }

    /// Makes a function of the flat model, and calls it; one that cannot be made is called as any other.
    fn call_as_flat_function(
        &mut self,
        class: ClassId,
        components: &Components,
        given: &[Option<Value>],
        span: Span,
    ) -> Option<Value> {
        let inputs = self.all_inputs(class, components, given)?;
        self.recursions.widened.retain(|(of, _)| *of != class);
        let (made, new) = self.collect_problems(|cx| {
            loop {
                let known = cx.widened(class);
                let made = cx.attempt(class, components, &inputs, span);
                let refused = cx.recursions.refused.contains_key(&class);
                if made.is_some() || refused || cx.widened(class) == known {
                    break made;
                }
                cx.recursions.unwinding = None;
                *cx.problems = Problems::new();
            }
        });
        if made.is_none()
            && let Some(Unwinding::To(other)) = self.recursions.unwinding
            && other != class
        {
            // One around it is read again.
            return None;
        }
        if let Some(function) = made
            && let Fit::Fits(arguments) = self.fit(&function, &inputs)
        {
            self.problems.extend(new);
            return Some(self.called(&function, arguments));
        }
        self.recursions.unwinding = None;
        let why = new.iter().find(|d| d.severity == Severity::Error).map(|d| d.message.clone());
        let why = why.unwrap_or_else(|| "its results depend on its depth".to_string());
        self.recursions.refused.entry(class).or_insert(why);
        // It may end for a reason of its own.
        self.run_function(class, components, given.to_vec(), span)
    }

    /// How many scalars of the arguments of a function are not the same in all calls.
    fn widened(&self, class: ClassId) -> usize {
        self.recursions.widened.iter().filter(|(of, _)| *of == class).count()
    }

    /// Executes the body of a function with symbols for the inputs that differ between calls.
    fn attempt(
        &mut self,
        class: ClassId,
        components: &Components,
        actual: &[Value],
        span: Span,
    ) -> Option<Recursive> {
        let (inputs, symbols) = self.symbolic(class, components, actual)?;
        let results = self.declared_results(class, components, &inputs)?;
        let id = FunctionId::from_usize(self.loops.functions.len());
        let name = self.classes[class].full_name.to_string();
        self.loops.functions.push(Function {
            name,
            span,
            inputs: Vec::new(),
            outputs: Vec::new(),
            locals: Default::default(),
            body: Vec::new(),
        });
        let known = symbols.iter().copied().collect();
        let function =
            Recursive { id, inputs: inputs.clone(), symbols: known, results, open: true };
        self.recursions.made.entry(class).or_default().push(function.clone());
        let given = inputs.into_iter().map(Some).collect();
        let (value, asserts) = self.collect_assertions(|cx| {
            cx.unconditionally(|cx| cx.run_function(class, components, given, span))
        });
        let value = value.filter(|_| !self.problems.has_errors());
        let body = value.and_then(|value| self.body(&function, &symbols, &value, asserts));
        let Some(body) = body else {
            self.forget(id);
            return None;
        };
        let slot = &mut self.loops.functions[id.idx()];
        *slot = Function { name: std::mem::take(&mut slot.name), span, ..body };
        for function in self.recursions.made.get_mut(&class).into_iter().flatten() {
            function.open = false;
        }
        Some(function)
    }

    /// Takes back all functions that were made from this one on.
    pub(super) fn forget(&mut self, first: FunctionId) {
        self.loops.functions.truncate(first.idx());
        self.loops.by_body.retain(|_, id| *id < first);
        self.recursions.made.retain(|_, all| {
            all.retain(|f| f.id < first);
            !all.is_empty()
        });
    }

    /// The inputs, with symbols for scalars that are unknown or were widened; discrete ones that
    /// parameters determine become known.
    fn symbolic(
        &mut self,
        class: ClassId,
        components: &Components,
        actual: &[Value],
    ) -> Option<(Vec<Value>, Vec<ExprId>)> {
        let mut declared = Vec::new();
        for (entry, declaration) in components {
            if self.causality(entry, declaration) == Some(Causality::Input) {
                declared.push(self.scalar_types(entry, declaration));
            }
        }
        let (mut inputs, mut symbols) = (Vec::new(), Vec::new());
        let mut count = 0;
        for (value, types) in actual.iter().zip(declared) {
            let mut at = 0;
            let symbolic = value.each_scalar(&mut |e| {
                count += 1;
                at += 1;
                if !self.recursions.widened.contains(&(class, count - 1))
                    && let Some(known) = self.constant_argument(e)
                {
                    return known;
                }
                let ty = match types.len() {
                    0 => self.graph.ty(e),
                    n => types[(at - 1) % n],
                };
                let symbol = self.class_graph.graph.var(symbol(self.loops.symbols), ty);
                self.loops.symbols += 1;
                symbols.push(symbol);
                symbol
            });
            inputs.push(symbolic);
        }
        Some((inputs, symbols))
    }

    /// The constant value of a scalar in all calls, if it has one.
    fn constant_argument(&mut self, e: ExprId) -> Option<ExprId> {
        if self.graph.as_const(e).is_some() {
            return Some(e);
        }
        if self.graph.ty(e) == Type::Real {
            return None;
        }
        let value = self.parameter_expression(e, true)?;
        Some(self.graph.constant(value))
    }

    /// Compares the arguments of a call with the inputs of a function.
    fn fit(&mut self, function: &Recursive, actual: &[Value]) -> Fit {
        if function.inputs.len() != actual.len() {
            return Fit::Differs;
        }
        let mut arguments = vec![self.active_condition()];
        let (mut others, mut number) = (Vec::new(), 0);
        for (formal, actual) in function.inputs.iter().zip(actual) {
            if !same_shape(formal, actual) {
                return Fit::Differs;
            }
            let mut given = Vec::new();
            actual.for_each_scalar(&mut |e| given.push(e));
            let mut given = given.into_iter();
            formal.for_each_scalar(&mut |e| {
                let argument = given.next().unwrap_or(e);
                if function.symbols.contains(&e) {
                    arguments.push(argument);
                } else if argument != e {
                    // Parameters that fix the structure have their values.
                    let known = self.constant_argument(argument);
                    if known != Some(e) {
                        others.push(number);
                    }
                }
                number += 1;
            });
        }
        if others.is_empty() { Fit::Fits(arguments) } else { Fit::Others(others) }
    }

    /// The condition under which the code being executed is active.
    pub(super) fn active_condition(&mut self) -> ExprId {
        let mut all = self.graph.boolean(true);
        for c in self.assertions.conditions.clone() {
            all = self.graph.and(all, c);
        }
        let exits = self.exits;
        let left = self.none_of(exits.all());
        self.graph.and(all, left)
    }

    /// The results of a call.
    fn called(&mut self, function: &Recursive, arguments: Vec<ExprId>) -> Value {
        let args = self.graph.intern_list(&arguments);
        let mut output = 0;
        let (graph, id) = (&mut self.graph, function.id);
        function.results.each_scalar(&mut |e| {
            let ty = graph.ty(e);
            output += 1;
            graph.intern(Node::Call { function: id, output: output - 1, args }, ty)
        })
    }

    /// The function that computes a value of symbols; `None` if it reads anything else.
    fn body(
        &mut self,
        function: &Recursive,
        symbols: &[ExprId],
        value: &Value,
        asserts: Vec<Asserted>,
    ) -> Option<Function> {
        if !same_shape(&function.results, value) {
            let class = *self
                .recursions
                .made
                .iter()
                .find(|(_, all)| all.iter().any(|f| f.id == function.id))?
                .0;
            return self.refuse(class, "the sizes of its outputs are not those that it declares");
        }
        let graph = &mut self.graph;
        // The first one says whether the call counts.
        let inputs = symbols.len() + 1;
        let mut locals: FastMap<VarId, u32> = FastMap::default();
        for (k, e) in symbols.iter().enumerate() {
            let Node::Var(v) = graph.node(*e) else { continue };
            locals.insert(v, k as u32 + 1);
        }
        let mut outputs = Vec::new();
        let mut types = Vec::new();
        function.results.for_each_scalar(&mut |e| types.push(graph.ty(e)));
        value.for_each_scalar(&mut |e| outputs.push(e));
        let mut rewriter = Rewriter::new();
        let mut closed = true;
        let mut local = |graph: &mut Graph, root: ExprId| {
            rewriter.apply(graph, root, &mut |g, n| {
                let Node::Var(v) = g.node(n) else { return None };
                let ty = g.ty(n);
                match locals.get(&v) {
                    Some(k) => Some(g.var(VarId(*k), ty)),
                    None => {
                        closed = false;
                        None
                    }
                }
            })
        };
        let id = |k: usize| LocalId::from_usize(k);
        let mut body = Vec::new();
        for (a, span) in asserts.iter().filter_map(Asserted::in_function) {
            let (condition, message) = (local(graph, a.condition), local(graph, a.message));
            body.push(Statement::Assert(Assert { condition, message, ..a }, span));
        }
        for (k, (e, ty)) in outputs.iter().zip(types).enumerate() {
            let e = local(graph, *e);
            let e = match graph.as_const(e) {
                Some(Const::Integer(n)) if ty == Type::Real => graph.real(n as f64),
                _ => e,
            };
            body.push(Statement::Assign(id(inputs + k), e));
        }
        if !closed {
            return None;
        }
        let active = graph.var(VarId(0), Type::Boolean);
        let mut names = vec!["counts".to_string()];
        names.extend((1..inputs).map(|k| format!("x{k}")));
        names.extend((1..=outputs.len()).map(|k| format!("y{k}")));
        Some(Function {
            name: String::new(),
            span: Span::NONE,
            inputs: (0..inputs).map(id).collect(),
            outputs: (inputs..names.len()).map(id).collect(),
            locals: names.into_iter().collect(),
            body: vec![Statement::If(active, body, Vec::new())],
        })
    }

    /// The values of all inputs, those that are not given by their defaults.
    fn all_inputs(
        &mut self,
        class: ClassId,
        components: &Components,
        given: &[Option<Value>],
    ) -> Option<Vec<Value>> {
        if let Some(all) = given.iter().cloned().collect() {
            return Some(all);
        }
        let mut inputs = Vec::new();
        for (k, (entry, declaration)) in components.iter().enumerate() {
            if self.causality(entry, declaration) == Some(Causality::Input) {
                inputs.push(k);
            }
        }
        let missing = inputs.iter().zip(given).filter(|(_, v)| v.is_none()).map(|(k, _)| *k);
        let missing = missing.collect();
        self.with_frame(FrameKind::Function, |cx| {
            cx.declare_for(class, components, given, missing)?;
            let locals = cx.frames.visible();
            let value = |k: &usize| {
                let name = components[*k].0.name.name;
                locals.iter().find(|(n, _)| *n == name).map(|(_, v)| v.clone())
            };
            inputs.iter().map(value).collect()
        })
    }

    /// Zeros of the sizes and types that the outputs are declared with.
    fn declared_results(
        &mut self,
        class: ClassId,
        components: &Components,
        inputs: &[Value],
    ) -> Option<Value> {
        let position = |name: Name| components.iter().position(|(e, _)| e.name.name == name);
        let mut outputs = Vec::new();
        for (entry, declaration) in components {
            if self.causality(entry, declaration) == Some(Causality::Output) {
                outputs.push((entry, declaration));
            }
        }
        let read = outputs.iter().flat_map(|(_, d)| super::function::read_before_values(d));
        let read = read.filter_map(position).collect();
        let given: Vec<Option<Value>> = inputs.iter().cloned().map(Some).collect();
        let mut zeros: Vec<Value> = self.with_frame(FrameKind::Function, |cx| {
            cx.declare_for(class, components, &given, read)?;
            outputs.iter().map(|(entry, d)| cx.declared_zero(entry, d)).collect::<Option<_>>()
        })?;
        match zeros.len() {
            1 => zeros.pop(),
            _ => Some(Value::Tuple(zeros.into())),
        }
    }

    /// Declares the inputs with their values, then these components and their dependencies.
    fn declare_for(
        &mut self,
        class: ClassId,
        components: &Components,
        given: &[Option<Value>],
        mut wanted: Vec<usize>,
    ) -> Option<()> {
        let mut values = vec![None; components.len()];
        let mut given = given.iter();
        for (k, (entry, declaration)) in components.iter().enumerate() {
            if self.causality(entry, declaration) == Some(Causality::Input) {
                values[k] = given.next().and_then(Clone::clone);
            }
        }
        let position = |name: Name| components.iter().position(|(e, _)| e.name.name == name);
        let mut needed = vec![false; components.len()];
        while let Some(k) = wanted.pop() {
            if !std::mem::replace(&mut needed[k], true) && values[k].is_none() {
                let (entry, declaration) = &components[k];
                wanted.extend(self.read_by(entry, declaration).into_iter().filter_map(position));
            }
        }
        for k in self.initial_order(class, components).iter() {
            let (entry, declaration) = &components[*k];
            let value = match values[*k].take() {
                Some(value) => value,
                None if needed[*k] => self.local_start(entry, declaration)?,
                None => continue,
            };
            self.frames.declare(entry.name.name, value);
        }
        Some(())
    }
}

/// Whether two values have the same sizes and fields.
fn same_shape(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Scalar(_), Value::Scalar(_)) => true,
        (Value::Array(a), Value::Array(b)) => {
            a.dims == b.dims && a.elements.iter().zip(&b.elements).all(|(a, b)| same_shape(a, b))
        }
        (Value::Record(a), Value::Record(b)) => {
            a.fields.len() == b.fields.len()
                && a.fields.iter().zip(&b.fields).all(|(a, b)| a.0 == b.0 && same_shape(&a.1, &b.1))
        }
        (Value::Tuple(a), Value::Tuple(b)) => {
            a.len() == b.len() && a.iter().zip(b.iter()).all(|(a, b)| same_shape(a, b))
        }
        (Value::Function(a), Value::Function(b)) => {
            a.class == b.class
                && a.bound.len() == b.bound.len()
                && a.bound
                    .iter()
                    .zip(&b.bound)
                    .all(|(a, b)| a.0.name == b.0.name && same_shape(&a.1, &b.1))
        }
        _ => false,
    }
}
