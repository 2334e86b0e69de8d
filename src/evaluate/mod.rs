//! Expressions of the language to values over the expression graph.
//!
//! There is one evaluator. By default a variable stands for itself; while *folding*, parameters and
//! constants stand for their values, and anything else is an error: so a size, a condition of a
//! component or a range is computed by the same code that builds the equations. Functions are
//! evaluated by running their algorithm on values that may be symbolic ([`algorithm`]).

pub mod algorithm;
mod array;
mod binding;
pub mod builtin;
mod collection;
pub mod draw;
mod dynamic_index;
mod event_behaviour;
pub mod external;
mod file;
mod fourier;
pub mod function;
mod function_argument;
pub mod history;
pub mod implicit_ranges;
pub mod operator;
pub mod overload;
mod partial_derivative;
mod random;
mod record;
mod recursion;
pub mod reference;
pub mod runtime_loop;
mod string;
mod subscript;
pub mod text;
pub mod value;
mod variability;

use std::rc::Rc;

use crate::base::diag::Diagnostic;
use crate::base::index::{FastMap, FastSet};
use crate::base::name::Name;
use crate::base::source::Span;
use crate::instantiate::Context;
use crate::ir::ast::{self, Expr, ExprKind};
use crate::ir::expr::{Const, ExprId, FunctionId, VarId};
use crate::ir::instance::{ClassId, InstanceId, Scope};
use value::Value;

/// Elements of the largest array.
pub(crate) const MAX_ELEMENTS: usize = 10_000_000;
/// How many calls of functions may be open at once.
const MAX_DEPTH: usize = 200;

/// What the evaluator remembers.
#[derive(Default)]
pub struct State {
    /// Iterators and variables of the function being run, innermost last.
    pub(crate) locals: Vec<(Name, Value)>,
    /// Locals below this belong to callers and are hidden.
    pub(crate) frame: usize,
    /// Inside a function: names of components are not visible.
    pub(crate) in_function: bool,
    /// Parameters stand for their values.
    pub(crate) folding: bool,
    /// Sizes that `end` stands for, innermost last.
    pub(crate) ends: Vec<usize>,
    /// Values of parameters that were asked for.
    pub(crate) folded: FastMap<InstanceId, Option<Value>>,
    /// Parameters whose values have fixed the structure.
    pub(crate) structural: Vec<InstanceId>,
    /// Values of bindings that are taken apart by arrays of components.
    pub(crate) bindings: FastMap<(usize, Scope, bool), Option<Value>>,
    /// Assigned variables of the algorithm section being read.
    pub(crate) assigned: FastMap<VarId, ExprId>,
    /// Calls of functions that are open, the innermost last.
    calls: Vec<recursion::Call>,
    /// Functions that call themselves.
    recursions: recursion::Recursions,
    /// The condition under which the loop, or the function, being run was left already.
    pub(crate) broken: Option<ExprId>,
    /// See `broken`.
    pub(crate) returned: Option<ExprId>,
    /// A value is read: what is conditional may not be.
    pub(crate) reading: bool,
    /// Variables stand for themselves, not for what an algorithm has assigned to them.
    pub(crate) unassigned: bool,
    /// The constant whose value is being found.
    pub(crate) constant: Option<InstanceId>,
    /// A constant with a unit stands as a number in what is being read.
    pub(crate) lost_unit: bool,
    /// Whether constants have units.
    pub(crate) has_unit: FastMap<InstanceId, bool>,
    /// Only sizes are wanted: what has no value yet counts as zero.
    pub(crate) shaping: bool,
    /// The orders in which the variables of functions get their first values.
    pub(crate) initial_orders: FastMap<ClassId, Rc<[usize]>>,
    /// Components whose sizes are being found, with those that are found already.
    pub(crate) sizing: Vec<(InstanceId, Vec<Option<usize>>)>,
    /// What each numbered flat variable is: for folding what stands in an expression.
    pub(crate) instance_of: Vec<(InstanceId, usize)>,
    /// Tables, by the number that stands for each.
    pub(crate) objects: Vec<external::Object>,
    /// Conditions, known only when the model runs, under which what is being run counts.
    pub(crate) path: Vec<ExprId>,
    /// What is read of the past.
    pub(crate) history: history::History,
    /// Random numbers whose generator keeps its state to itself.
    pub(crate) draws: draw::Draws,
    /// Functions made of loops whose length only a run knows.
    pub(crate) functions: Vec<crate::ir::flat::Function>,
    /// Their numbers, by place, by how many arguments they have and by their expressions: a loop that is
    /// met again is the same.
    loops: FastMap<(Span, usize, Vec<ExprId>), FunctionId>,
    /// How many symbols such loops have.
    pub(crate) symbols: u32,
    /// Assertions of functions that only a run can decide.
    pub(crate) asserts: Vec<external::Asserted>,
    /// Results of functions of discrete type that change between events, since their arguments do.
    pub(crate) moving: FastSet<ExprId>,
    /// Names that stand for no function of the user where they were called: what is built in is meant.
    pub(crate) plain_names: FastSet<(ClassId, Name)>,
    /// What is known of the change of each expression.
    motions: Vec<event_behaviour::EventBehaviour>,
    /// In how many connections each connector is; known where equations are read.
    pub(crate) cardinality: Option<FastMap<InstanceId, usize>>,
}

impl Context<'_> {
    /// The value of an expression; of a function with several outputs the first. `None` after an error.
    pub fn evaluate(&mut self, e: &Expr, scope: Scope) -> Option<Value> {
        match self.evaluate_outputs(e, scope)? {
            Value::Tuple(all) if !all.is_empty() && !matches!(e.kind, ExprKind::Tuple(_)) => {
                Some(all[0].clone())
            }
            value => Some(value),
        }
    }

    /// As [`Context::evaluate`], with all outputs of a function.
    pub fn evaluate_outputs(&mut self, e: &Expr, scope: Scope) -> Option<Value> {
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
                self.binary_operator(*op, a_value?, b_value?, e.span)
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
                            self.error("MO0211", e.span, "a value is missing in this list");
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
            ExprKind::End => match self.evaluation.ends.last() {
                Some(n) => Some(Value::Scalar(self.graph.integer(*n as i64))),
                None => {
                    self.error("MO0211", e.span, "`end` stands only in subscripts");
                    None
                }
            },
            ExprKind::PartialFunction { .. } => {
                self.error("MO0212", e.span, "a function stands in calls of functions only");
                None
            }
            ExprKind::Break => {
                self.unsupported(e.span, "`break` in modifications");
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
                let what = match other {
                    Value::Record(_) => "a record".to_string(),
                    Value::Function(_) => "a function".to_string(),
                    other => format!("an array of size {:?}", other.dims()),
                };
                let message = format!("a scalar is needed here, and this is {what}");
                self.error("MO0212", span, message);
                None
            }
        }
    }

    /// The value of an expression that must be known before the model runs; reported if it is not.
    pub fn fold(&mut self, e: &Expr, scope: Scope) -> Option<Value> {
        let before = std::mem::replace(&mut self.evaluation.folding, true);
        let value = self.evaluate(e, scope);
        self.evaluation.folding = before;
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
                Diagnostic::error(
                    "MO0213",
                    e.span,
                    "this must be known before the model runs, and depends on what only a run knows",
                )
                .label("needed to fix the structure of the model")
                .help("use parameters and constants with values only"),
            );
            return None;
        }
        Some(value)
    }

    /// A truth value that must be known before the model runs.
    pub fn fold_boolean(&mut self, e: &Expr, scope: Scope) -> Option<bool> {
        let value = self.fold(e, scope)?;
        match value.scalar().and_then(|s| self.graph.as_const(s)) {
            Some(Const::Boolean(b)) => Some(b),
            _ => {
                self.report_no_truth(&value, e.span);
                None
            }
        }
    }

    /// A size: a whole number, or the number of values of an enumeration or of `Boolean`.
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
                self.error("MO0207", e.span, format!("a size cannot be negative, and this is {n}"));
                None
            }
            _ => {
                self.error("MO0212", e.span, "a whole number is needed here");
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
        let message = format!("{} elements are too many for one array", shown.join(" times "));
        self.problems.push(
            Diagnostic::error("MO0207", span, message)
                .help(format!("use no more than {MAX_ELEMENTS}, or several arrays")),
        );
        None
    }

    /// Whole numbers that must be known before the model runs, such as the values of an iterator.
    pub(crate) fn fold_range(
        &mut self,
        iterator: &ast::Iterator,
        scope: Scope,
    ) -> Option<Vec<Value>> {
        let Some(range) = &iterator.range else {
            self.unsupported(iterator.name.span, "iterators without a range");
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
                self.error("MO0212", range.span, "a vector is needed here to run over");
                None
            }
        }
    }

    /// Opens a scope of locals that hides those of callers.
    pub(crate) fn enter_frame(&mut self, in_function: bool) -> (usize, bool) {
        let saved = (self.evaluation.frame, self.evaluation.in_function);
        self.evaluation.frame = self.evaluation.locals.len();
        self.evaluation.in_function = in_function;
        saved
    }

    /// Closes it.
    pub(crate) fn leave_frame(&mut self, saved: (usize, bool)) {
        self.evaluation.locals.truncate(self.evaluation.frame);
        (self.evaluation.frame, self.evaluation.in_function) = saved;
    }
}
