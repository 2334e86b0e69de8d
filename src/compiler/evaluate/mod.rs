//! Expressions of the language to values over the expression graph.
//!
//! There is one evaluator. By default a variable stands for itself; in the folding [`mode`],
//! parameters and constants stand for their values and anything else is an error. So a size, a
//! condition of a component or a range is computed by the same code that builds the equations.
//! Functions are evaluated by executing their algorithms on values that may be symbolic
//! ([`algorithm`]).

pub mod algorithm;
mod argument_unit;
mod array;
pub(crate) mod assertion;
mod binding;
pub mod budget;
pub mod builtin;
pub mod cause;
mod clock;
mod collection;
pub mod connection_operator;
mod definite_assignment;
pub mod demand;
mod dynamic_index;
mod enumeration;
mod error;
mod event_behaviour;
pub mod external;
mod fourier;
pub mod frame;
pub mod function;
mod function_argument;
mod given_derivative;
pub mod history;
pub mod implicit_ranges;
pub mod inline;
mod known_table;
mod linear_algebra;
mod loop_function;
mod lu_factors;
pub mod mode;
mod moved_table;
pub mod operator;
pub mod overload;
mod partial_derivative;
pub(crate) mod pattern;
mod random;
pub mod random_draw;
mod record;
mod record_binding;
mod record_modifier;
mod recursion;
pub mod reference;
pub mod runtime_loop;
mod runtime_reduction;
mod sizing;
mod specialization;
mod string;
mod subscript;
pub mod value;
mod variability;

use std::ops::{Deref, DerefMut};
use std::rc::Rc;

use crate::base::diag::Diagnostic;
use crate::base::index::FastMap;
use crate::base::source::Span;
use crate::classes::ClassGraph;
use crate::classes::unsupported::Construct;
use crate::ir::ast::{self, Expr, ExprKind};
use crate::ir::expr::{Const, ExprId, VarId};
use crate::ir::instance::{ClassId, InstanceId, Scope};
use cause::array::ArrayCause;
use cause::name::NameCause;
use cause::types::Expected;
use cause::value::ValueCause;
use value::Value;

/// Elements of the largest array.
pub(crate) const MAX_ELEMENTS: usize = 10_000_000;
/// How many calls of functions may be open at once.
const MAX_DEPTH: usize = 200;

/// Evaluates expressions and keeps the results. Each part of its state belongs to the file that
/// defines the type.
pub struct Evaluator<'a> {
    /// Classes, and the component tree.
    pub class_graph: ClassGraph<'a>,
    /// The meaning of names.
    pub(crate) mode: mode::Mode,
    /// Iterators, and the variables of the functions being run.
    pub(crate) frames: frame::Frames,
    /// Sizes that `end` stands for, innermost last.
    pub(crate) ends: Vec<usize>,
    /// Values that the current algorithm section has assigned to variables of the model.
    pub(crate) assigned: FastMap<VarId, ExprId>,
    /// How the loop and the function being run were left.
    pub(crate) exits: algorithm::Exits,
    /// Values of parameters and bindings.
    pub(crate) parameters: binding::ParameterValues,
    /// Constants with units that are read as plain numbers.
    pub(crate) units: reference::Units,
    /// Arguments of functions whose inputs have units.
    pub(crate) argument_units: argument_unit::ArgumentUnits,
    /// Assertions that are left to the run.
    pub(crate) assertions: assertion::Assertions,
    /// Open calls, and functions that call themselves.
    pub(crate) recursions: recursion::Recursions,
    /// Functions whose bodies were executed on symbols.
    pub(crate) specializations: specialization::Specializations,
    /// Functions of the flat model.
    pub(crate) loops: runtime_loop::Loops,
    /// The orders in which the variables of functions get their first values.
    pub(crate) initial_orders: FastMap<ClassId, Rc<[usize]>>,
    /// The declared types and sizes of variables.
    pub(crate) patterns: pattern::Patterns,
    /// Components whose sizes are being found.
    pub(crate) sizing: sizing::Sizing,
    /// The component of each numbered flat variable, and the position in it.
    pub(crate) instance_of: Vec<(InstanceId, usize)>,
    /// How expressions behave at events and between them.
    pub(crate) events: event_behaviour::Events,
    /// Tables, by the number that stands for each.
    pub(crate) objects: Vec<external::Object>,
    /// Delayed expressions, and lines along which something is transported.
    pub(crate) history: history::History,
    /// Random numbers whose generator has a hidden state.
    pub(crate) random_draws: random_draw::RandomDraws,
    /// Built-in functions.
    pub(crate) builtins: builtin::Builtins,
    /// The model is a component by itself: its surroundings are missing.
    pub surrounded: bool,
    /// Records of which a value is being made, outermost first.
    pub(crate) open_records: Vec<ClassId>,
    /// What the model may take.
    pub budget: budget::Budget,
}

impl<'a> Deref for Evaluator<'a> {
    type Target = ClassGraph<'a>;

    fn deref(&self) -> &ClassGraph<'a> {
        &self.class_graph
    }
}

impl<'a> DerefMut for Evaluator<'a> {
    fn deref_mut(&mut self) -> &mut ClassGraph<'a> {
        &mut self.class_graph
    }
}

impl<'a> Evaluator<'a> {
    /// An evaluator over classes of which no component has been evaluated.
    pub fn new(class_graph: ClassGraph<'a>) -> Self {
        Evaluator {
            class_graph,
            mode: Default::default(),
            frames: Default::default(),
            ends: Default::default(),
            assigned: Default::default(),
            exits: Default::default(),
            parameters: Default::default(),
            units: Default::default(),
            argument_units: Default::default(),
            assertions: Default::default(),
            recursions: Default::default(),
            specializations: Default::default(),
            loops: Default::default(),
            initial_orders: Default::default(),
            patterns: Default::default(),
            sizing: Default::default(),
            instance_of: Default::default(),
            events: Default::default(),
            objects: Default::default(),
            history: Default::default(),
            random_draws: Default::default(),
            builtins: Default::default(),
            surrounded: false,
            open_records: Default::default(),
            budget: Default::default(),
        }
    }
}

impl Evaluator<'_> {
    /// True if there are tables or foreign models.
    pub fn has_objects(&self) -> bool {
        !self.objects.is_empty()
    }

    /// The value of an expression; of a function with several outputs the first. `None` after an error.
    pub fn evaluate(&mut self, e: &Expr, scope: Scope) -> Option<Value> {
        match self.evaluate_outputs(e, scope)? {
            Value::Tuple(all) if !all.is_empty() && !matches!(e.kind, ExprKind::Tuple(_)) => {
                Some(all[0].clone())
            }
            value => Some(value),
        }
    }

    /// As [`Evaluator::evaluate`], with all outputs of a function.
    pub fn evaluate_outputs(&mut self, e: &Expr, scope: Scope) -> Option<Value> {
        self.spend(1, e.span)?;
        match &e.kind {
            ExprKind::Real(x) => Some(Value::Scalar(self.graph.real(*x))),
            ExprKind::Integer(i) => Some(Value::Scalar(self.graph.integer(*i))),
            ExprKind::String(s) => Some(Value::Scalar(self.graph.string(s))),
            ExprKind::Boolean(b) => Some(Value::Scalar(self.graph.boolean(*b))),
            ExprKind::Ref(r) => self.reference(r, scope),
            ExprKind::Parenthesised(inner) => self.evaluate(inner, scope),
            ExprKind::Unary(op, a) => {
                let a = self.evaluate(a, scope)?;
                self.unary_operator(*op, a, e.span)
            }
            ExprKind::Binary(op, a, b) => {
                let a_value = self.evaluate(a, scope);
                let b_value = self.guarded(*op, a_value.as_ref(), b, scope);
                let value = self.binary_operator(*op, a_value?, b_value?, e.span)?;
                let is_product = matches!(op, ast::BinaryOp::Mul | ast::BinaryOp::ElementMul);
                if is_product && [a, b].into_iter().any(|e| self.is_actual_stream(e)) {
                    return value
                        .map(|v| v.scalar().map(|e| Value::Scalar(self.graph.smooth(0, e))));
                }
                Some(value)
            }
            ExprKind::If { branches, otherwise } => self.if_expression(branches, otherwise, scope),
            ExprKind::Call { function, args, named } => {
                self.call(function, args, named, e.span, scope)
            }
            ExprKind::Reduction { function, body, iterators } => {
                self.reduction(function, body, iterators, scope, e.span)
            }
            ExprKind::Array(items) => {
                let values = self.evaluate_all(items, scope)?;
                self.stack(values, e.span)
            }
            ExprKind::Comprehension { body, iterators } => {
                self.comprehension(body, iterators, scope)
            }
            ExprKind::Matrix(rows) => {
                let mut parts = Vec::new();
                for row in rows {
                    let values = self.evaluate_all(row, scope)?;
                    parts.push(self.concatenate(2, values, e.span)?);
                }
                self.concatenate(1, parts, e.span)
            }
            ExprKind::Range { start, step, stop } => {
                self.range(start, step.as_deref(), stop, scope, e.span)
            }
            ExprKind::Tuple(items) => {
                let mut values = Vec::new();
                for item in items {
                    match item {
                        Some(item) => values.push(self.evaluate(item, scope)?),
                        None => {
                            self.report(ValueCause::MissingValue, e.span);
                            return None;
                        }
                    }
                }
                Some(Value::Tuple(values.into()))
            }
            ExprKind::Indexed(inner, subscripts) => {
                let value = self.evaluate(inner, scope)?;
                self.subscripted(value, subscripts, scope, e.span)
            }
            ExprKind::End => match self.ends.last().copied() {
                Some(n) => Some(Value::Scalar(self.graph.integer(n as i64))),
                None => {
                    self.report(ArrayCause::EndOutsideSubscript, e.span);
                    None
                }
            },
            ExprKind::PartialFunction { .. } => {
                self.report(NameCause::FunctionAsValue, e.span);
                None
            }
            ExprKind::Break => {
                self.unsupported(e.span, Construct::Break);
                None
            }
            ExprKind::Broken => None,
        }
    }

    fn evaluate_all(&mut self, items: &[Expr], scope: Scope) -> Option<Vec<Value>> {
        let values: Vec<_> = items.iter().map(|i| self.evaluate(i, scope)).collect();
        values.into_iter().collect()
    }

    /// A scalar value; anything else is reported.
    pub fn evaluate_scalar(&mut self, e: &Expr, scope: Scope) -> Option<ExprId> {
        let value = self.evaluate(e, scope)?;
        self.scalar_of(value, e.span)
    }

    /// The scalar that a value is; reported if it is none.
    pub(crate) fn scalar_of(&mut self, value: Value, span: Span) -> Option<ExprId> {
        match value {
            Value::Scalar(s) => Some(s),
            other => {
                self.report_type(Expected::Scalar, &other, span);
                None
            }
        }
    }

    /// The scalar value of an expression that must be known before the model runs; anything else is reported.
    pub(super) fn fold_scalar(&mut self, e: &Expr, scope: Scope) -> Option<ExprId> {
        let value = self.fold(e, scope)?;
        self.scalar_of(value, e.span)
    }

    /// The value of an expression that must be known before the model runs; reported if it is not.
    pub fn fold(&mut self, e: &Expr, scope: Scope) -> Option<Value> {
        let mode = self.mode.folding();
        let value = self.with_mode(mode, |cx| cx.evaluate(e, scope));
        let mut known = true;
        let value = value?.each_scalar(&mut |s| match self.parameter_expression(s, true) {
            Some(c) => self.graph.constant(c),
            None => {
                known = false;
                s
            }
        });
        if !known {
            self.problems.push(
                Diagnostic::new(ValueCause::NotEvaluable { path: None }, e.span)
                    .label("needed to fix the structure of the model"),
            );
            return None;
        }
        Some(value)
    }

    /// A Boolean that must be known before simulation.
    pub fn fold_boolean(&mut self, e: &Expr, scope: Scope) -> Option<bool> {
        let value = self.fold(e, scope)?;
        match value.scalar().and_then(|s| self.graph.as_const(s)) {
            Some(Const::Boolean(b)) => Some(b),
            _ => {
                self.report_type(Expected::Boolean, &value, e.span);
                None
            }
        }
    }

    /// A size: an Integer, or the number of values of an enumeration or of `Boolean`.
    pub fn fold_size(&mut self, e: &Expr, scope: Scope) -> Option<usize> {
        if let ExprKind::Ref(r) = &e.kind
            && let Some(n) = self.type_size(r, scope)
        {
            return Some(n);
        }
        let value = self.fold(e, scope)?;
        match value.scalar().and_then(|s| self.graph.as_const(s)) {
            Some(Const::Integer(n)) if n >= 0 => {
                self.check_count(&[n as usize], e.span)?;
                Some(n as usize)
            }
            Some(Const::Integer(n)) => {
                self.report(ArrayCause::NegativeSize { size: n }, e.span);
                None
            }
            _ => {
                self.report_type(Expected::Integer, &value, e.span);
                None
            }
        }
    }

    /// Reports sizes whose elements no memory would hold.
    pub(crate) fn check_count(&mut self, dims: &[usize], span: Span) -> Option<()> {
        let count = dims.iter().try_fold(1_usize, |n, d| n.checked_mul(*d));
        if count.is_some_and(|n| n <= MAX_ELEMENTS) {
            return Some(());
        }
        let shown: Vec<String> = dims.iter().map(usize::to_string).collect();
        let count = shown.join(" times ");
        self.report(ArrayCause::TooManyElements { count, most: MAX_ELEMENTS }, span);
        None
    }

    /// Integers that must be known before simulation, such as the values of an iterator.
    pub(crate) fn fold_range(
        &mut self,
        iterator: &ast::Iterator,
        scope: Scope,
    ) -> Option<Vec<Value>> {
        let Some(range) = &iterator.range else {
            self.unsupported(iterator.name.span, Construct::IteratorWithoutRange);
            return None;
        };
        if let ExprKind::Ref(r) = &range.kind
            && let Some(values) = self.type_values(r, scope)
        {
            return Some(values);
        }
        let value = self.fold(range, scope)?;
        match &value {
            Value::Array(a) if a.dims.len() == 1 => Some(a.elements.clone()),
            _ => {
                self.report_type(Expected::Vector, &value, range.span);
                None
            }
        }
    }
}
