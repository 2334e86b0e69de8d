//! Expressions of the language to values over the expression graph.
//!
//! There is one evaluator. By default a variable stands for itself; while *folding*, parameters and
//! constants stand for their values, and anything else is an error: so a size, a condition of a
//! component or a range is computed by the same code that builds the equations. Functions are
//! evaluated by running their algorithm on values that may be symbolic ([`algorithm`]).

pub mod algorithm;
mod array;
pub mod builtin;
mod choice;
pub mod deduce;
mod derivative;
pub mod draw;
mod eventless;
pub mod external;
mod file;
mod fourier;
pub mod function;
pub mod operator;
pub mod overload;
mod partial;
pub mod past;
mod random;
pub mod reference;
pub mod repeat;
pub mod text;
pub mod value;

use std::rc::Rc;

use super::Context;
use crate::base::diag::{Diagnostic, did_you_mean};
use crate::base::index::{FastMap, FastSet};
use crate::base::name::Name;
use crate::base::source::Span;
use crate::ir::ast::{self, Expr, ExprKind, Variability};
use crate::ir::expr::{Binary, Const, ExprId, Node, Type, Unary, VarId};
use crate::ir::instance::{ClassId, InstanceId, InstanceKind, Scope};
use value::Value;

/// Elements of the largest array.
const MAX_ELEMENTS: usize = 10_000_000;
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
    /// Texts that stand for those of values that only a run knows, and the places of their calls of
    /// `String`: good for messages alone.
    pub(crate) unknown_texts: FastMap<ExprId, Span>,
    /// Functions whose calls are open, the innermost last.
    pub(crate) calls: Vec<ClassId>,
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
    pub(crate) past: past::Past,
    /// Random numbers whose generator keeps its state to itself.
    pub(crate) draws: draw::Draws,
    /// Functions made of loops whose length only a run knows.
    pub(crate) functions: Vec<crate::ir::flat::Function>,
    /// How many symbols such loops have.
    pub(crate) symbols: u32,
    /// Assertions of functions that only a run can decide.
    pub(crate) asserts: Vec<external::Asserted>,
    /// Results of functions of discrete type that change between events, since their arguments do.
    pub(crate) moving: FastSet<ExprId>,
    /// Names that stand for no function of the user where they were called: what is built in is meant.
    pub(crate) plain_names: FastSet<(ClassId, Name)>,
    /// What is known of the change of each expression.
    motions: Vec<eventless::Motion>,
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
    pub(super) fn scalar_of(&mut self, value: Value, span: Span) -> Option<ExprId> {
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

    /// The value of a parameter or constant; reported if it has none.
    pub(crate) fn parameter_value(&mut self, id: InstanceId, span: Span) -> Option<Value> {
        if let Some(known) = self.evaluation.folded.get(&id) {
            return known.clone();
        }
        // Met again before it has a value, it depends on itself.
        self.evaluation.folded.insert(id, None);
        let before = std::mem::replace(&mut self.evaluation.folding, true);
        let is_constant = self.instances[id].prefix.variability == Some(Variability::Constant);
        let constant = is_constant.then_some(id);
        let constant = std::mem::replace(&mut self.evaluation.constant, constant);
        let shaping = std::mem::replace(&mut self.evaluation.shaping, false);
        let saved = self.enter_frame(false);
        let mut value = self.binding_value(id);
        if value.is_none() && self.binding(id).is_none() {
            value = self.start_or_children(id, span);
        }
        self.leave_frame(saved);
        (self.evaluation.folding, self.evaluation.shaping) = (before, shaping);
        self.evaluation.constant = constant;
        if let InstanceKind::Variable { ty: Type::Real, .. } = self.instances[id].kind
            && let Some(found) = &value
        {
            let real = found.each_scalar(&mut |e| self.graph.as_real(e));
            value = Some(real);
        }
        self.evaluation.folded.insert(id, value.clone());
        self.evaluation.structural.push(id);
        value
    }

    /// A parameter without a binding: its start value, or the values of its components.
    fn start_or_children(&mut self, id: InstanceId, span: Span) -> Option<Value> {
        self.complete(id);
        match self.instances[id].kind.clone() {
            InstanceKind::Variable { ty, dims, .. } => {
                if let Some(start) = self.attribute(id, crate::base::name::name("start")) {
                    let value = self.evaluate(&start.value, start.scope)?;
                    return self.spread(value, &dims, &start.subscripts, start.value.span);
                }
                let path = self.path(id);
                let declared = self.declared_at(id);
                let constant = self.instances[id].prefix.variability == Some(Variability::Constant);
                let what = if constant { "constant" } else { "parameter" };
                self.problems.push(
                    Diagnostic::error("MO0214", span, format!("{what} `{path}` has no value"))
                        .label("needed here before the model runs")
                        .also(declared, "declared here")
                        .help(format!("give it one: `{path} = ...`")),
                );
                let _ = ty;
                None
            }
            InstanceKind::Object(_) | InstanceKind::Array { .. } => self.instance_value(id, span),
            InstanceKind::Outer(inner) => self.parameter_value(inner, span),
            _ => None,
        }
    }

    /// The value that the declaration or a modification binds to an instance: its own, or the field of
    /// the record around it that is bound as a whole.
    pub fn binding_value(&mut self, id: InstanceId) -> Option<Value> {
        if let Some(binding) = self.binding(id).filter(|_| !self.outranked(id)) {
            // A record is asked for by each of its fields.
            let record = matches!(self.instances[id].kind, InstanceKind::Object(_));
            let keep =
                !binding.subscripts.is_empty() || (record && self.evaluation.assigned.is_empty());
            let value = self.cached(&binding.value, binding.scope, keep, id)?;
            let dims = binding.subscripts.clone();
            if !binding.setting {
                self.check_extent(id, &value, &dims, binding.value.span);
            }
            return self.taken_apart(value, &dims, binding.setting, binding.value.span);
        }
        let parent = self.instances[id].parent?;
        if !self.bound(parent) {
            return None;
        }
        match self.instances[parent].kind {
            InstanceKind::Object(_) => {
                let name = self.instances[id].name;
                self.binding_value(parent)?.field(name)
            }
            InstanceKind::Array { .. } => {
                let subscripts = self.instances[id].subscripts.clone();
                self.binding_value(parent)?.select(&subscripts)
            }
            _ => None,
        }
    }

    /// True if the binding of a record around an instance comes from further out than its own: the
    /// record as a whole takes the place of what its class says of its fields (section 7.2.4).
    fn outranked(&self, id: InstanceId) -> bool {
        let Some(parent) = self.instances[id].parent else { return false };
        // A constant that its class gives a value is no field that a constructor could give another.
        if self.instances[id].declaration.as_ref().is_some_and(function::is_constant) {
            return false;
        }
        match self.instances[parent].kind {
            InstanceKind::Object(_) => {}
            // An element is what its array is.
            InstanceKind::Array { .. } => return self.outranked(parent),
            _ => return false,
        }
        let name = self.instances[id].name;
        let mut own = Vec::new();
        for layer in self.instances[parent].layers.iter() {
            layer.child(name, &mut own);
            if own.iter().any(|l| l.binding().is_some()) {
                return false;
            }
            if layer.binding().is_some() {
                return true;
            }
        }
        self.outranked(parent)
    }

    /// True if the instance or a record around it has a binding.
    pub fn bound(&self, id: InstanceId) -> bool {
        if self.binding(id).is_some() {
            return true;
        }
        match self.instances[id].parent {
            Some(p) => match self.instances[p].kind {
                InstanceKind::Object(_) | InstanceKind::Array { .. } => self.bound(p),
                _ => false,
            },
            None => false,
        }
    }

    fn cached(
        &mut self,
        e: &std::sync::Arc<Expr>,
        scope: Scope,
        keep: bool,
        target: InstanceId,
    ) -> Option<Value> {
        let key = (std::sync::Arc::as_ptr(e) as usize, scope, self.evaluation.folding);
        let keep = keep && !self.evaluation.shaping;
        if keep && let Some(known) = self.evaluation.bindings.get(&key) {
            return known.clone();
        }
        let saved = self.enter_frame(false);
        let value = match self.bare_literal(e, target) {
            Some(literal) => literal,
            None => self.evaluate(e, scope),
        };
        self.leave_frame(saved);
        if keep {
            self.evaluation.bindings.insert(key, value.clone());
        }
        value
    }

    /// A setting from outside may name an enumeration literal without its type. `Some(None)` if the
    /// type has no such literal, which is reported.
    fn bare_literal(&mut self, e: &Expr, target: InstanceId) -> Option<Option<Value>> {
        let ExprKind::Ref(r) = &e.kind else { return None };
        if !self.binding(target)?.setting {
            return None;
        }
        let InstanceKind::Variable { ty: Type::Enumeration(id), .. } = self.instances[target].kind
        else {
            return None;
        };
        let wanted = r.simple()?;
        let ty = &self.graph.enumerations[id];
        if let Some(at) = ty.literals.iter().position(|l| *l == wanted) {
            let literal = Const::Enumeration(id, at as u32 + 1);
            return Some(Some(Value::Scalar(self.graph.constant(literal))));
        }
        let names: Vec<&str> = ty.literals.iter().map(|l| l.as_str()).collect();
        let message = format!("`{}` has no literal `{wanted}`", ty.name);
        let help = match did_you_mean(&wanted, names.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("it has {}", crate::instantiate::error::listed(&names)),
        };
        self.problems.push(Diagnostic::error("MO0240", e.span, message).help(help));
        Some(None)
    }

    /// Reports a value with more elements than the array of components that it modifies. Too few are
    /// noticed where one is missing.
    pub(crate) fn check_extent(
        &mut self,
        id: InstanceId,
        value: &Value,
        subscripts: &[usize],
        span: Span,
    ) {
        let depth = subscripts.len();
        // Once is enough: for the first element.
        if depth == 0 || value.dims().len() < depth || subscripts.iter().any(|s| *s != 1) {
            return;
        }
        let mut extents: Vec<usize> = Vec::new();
        let mut at = Some(id);
        while let Some(i) = at {
            at = self.instances[i].parent;
            if !self.instances[i].subscripts.is_empty()
                && let Some(InstanceKind::Array { dims, .. }) = at.map(|p| &self.instances[p].kind)
            {
                extents.splice(0..0, dims.iter().copied());
            }
        }
        let Some(first) = extents.len().checked_sub(depth) else { return };
        let wanted = &extents[first..];
        let found = &value.dims()[..depth];
        if found.iter().zip(wanted).any(|(a, b)| a > b) {
            let message = format!(
                "this has size {found:?}, too many for the array of components of size {wanted:?} that it modifies"
            );
            self.problems.push(
                Diagnostic::error("MO0215", span, message)
                    .help("give one value for each element, or write `each` before the modification if all get the same"),
            );
        }
    }

    /// The part of a value for one element of an array of components.
    fn taken_apart(
        &mut self,
        value: Value,
        subscripts: &[usize],
        setting: bool,
        span: Span,
    ) -> Option<Value> {
        if subscripts.is_empty() || (setting && value.dims().is_empty()) {
            return Some(value);
        }
        if let Some(part) = value.select(subscripts) {
            return Some(part);
        }
        let dims = value.dims();
        let d = if dims.is_empty() {
            let message = "this is one value, and it modifies an array of components";
            Diagnostic::error("MO0215", span, message)
        } else {
            let message = format!(
                "this has size {dims:?}, too few for the array of components that it modifies"
            );
            Diagnostic::error("MO0215", span, message)
        };
        self.problems.push(d.help(
            "write `each` before the modification if all get the same, else one value for each",
        ));
        None
    }

    /// A value of the sizes `dims`: a scalar is spread over all elements where `each` allows it.
    pub(crate) fn spread(
        &mut self,
        value: Value,
        dims: &[usize],
        subscripts: &Rc<[usize]>,
        span: Span,
    ) -> Option<Value> {
        let value = self.taken_apart_softly(value, subscripts);
        if value.dims() == dims {
            return Some(value);
        }
        if value.dims().is_empty() {
            let n: usize = dims.iter().product();
            return Some(Value::array(dims.to_vec(), vec![value; n]));
        }
        let message = format!("sizes differ: {:?} is needed and this is {:?}", dims, value.dims());
        self.error("MO0215", span, message);
        None
    }

    fn taken_apart_softly(&self, value: Value, subscripts: &[usize]) -> Value {
        if value.dims().is_empty() {
            return value;
        }
        value.select(subscripts).unwrap_or(value)
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

    /// The slowest class of change of what an expression reads.
    pub fn variability(&self, e: ExprId) -> Variability {
        let mut most = Variability::Constant;
        for n in self.graph.postorder([e]) {
            let v = match self.graph.node(n) {
                Node::Var(v) => self.variable_variability(v),
                Node::Time | Node::Der(_) | Node::Recorded(..) => Variability::Continuous,
                Node::Pre(_) | Node::Initial | Node::Terminal | Node::Sample(..) => {
                    Variability::Discrete
                }
                _ => Variability::Constant,
            };
            most = most.max(v);
        }
        most
    }

    /// Whether a value may change between events: relations and what counts in steps change at events
    /// only, unless they stand in a function (section 3.8.3). Who writes `noEvent` knows what that does.
    pub fn changes_between_events(&self, e: ExprId) -> bool {
        let mut moving: FastMap<ExprId, bool> = FastMap::default();
        for n in self.graph.postorder([e]) {
            let mut moves = false;
            self.graph.for_each_operand(n, |a| moves |= moving[&a]);
            let moves = match self.graph.node(n) {
                _ if self.evaluation.moving.contains(&n) => true,
                Node::Var(v) => self.variable_variability(v) == Variability::Continuous,
                Node::Time | Node::Der(_) | Node::Recorded(..) => true,
                Node::Unary(Unary::Floor | Unary::Ceil | Unary::ToInteger | Unary::Sign, _) => {
                    false
                }
                Node::Binary(op, ..) if op.is_relation() || op == Binary::Quotient => false,
                _ => moves,
            };
            moving.insert(n, moves);
        }
        moving[&e]
    }

    /// Reports a value that changes between events for a variable that does not.
    pub(crate) fn report_continuous(&mut self, ty: Type, span: Span) {
        let name = crate::symbolic::print::type_name(&self.graph, ty);
        self.problems.push(
            Diagnostic::error(
                "MO0247",
                span,
                format!(
                    "a value of type {name} changes at events only, and this changes between them"
                ),
            )
            .help("write the relation where the function is called, or compute it in a when-clause")
            .note("section 3.8.3 of the specification"),
        );
    }

    fn variable_variability(&self, v: VarId) -> Variability {
        let Some((id, _)) = self.evaluation.instance_of.get(v.0 as usize) else {
            return self.made_variability(v);
        };
        let instance = &self.instances[*id];
        let discrete_type =
            matches!(&instance.kind, InstanceKind::Variable { ty, .. } if *ty != Type::Real);
        match instance.prefix.variability {
            Some(v) => v,
            None if discrete_type => Variability::Discrete,
            None => Variability::Continuous,
        }
    }

    /// The value of an expression that reads parameters of discrete type only (truth values, whole
    /// numbers, choices): such parameters fix the structure, as conditions of components do.
    pub(crate) fn structural_value(&mut self, e: ExprId) -> Option<Const> {
        self.parameter_expression(e, false)
    }

    /// The value of an expression that reads parameters only; `reals` says whether Real ones count.
    pub(crate) fn parameter_expression(&mut self, e: ExprId, reals: bool) -> Option<Const> {
        if let Some(c) = self.graph.as_const(e) {
            return Some(c);
        }
        // Most of what has no value shows it on the first way down, whatever stands beside.
        if !self.may_be_known(self.first_leaf(e), reals) {
            return None;
        }
        let order = self.graph.postorder([e]);
        if !order.iter().all(|n| self.may_be_known(*n, reals)) {
            return None;
        }
        let mut values: FastMap<VarId, ExprId> = FastMap::default();
        for &n in &order {
            if let Node::Var(v) = self.graph.node(n) {
                let (id, k) = self.evaluation.instance_of[v.0 as usize];
                if !self.bound(id) {
                    return None;
                }
                let span = self.declared_at(id);
                let value = self.parameter_value(id, span)?;
                values.insert(v, value.elements().get(k)?.scalar()?);
            }
        }
        let mut rewriter = crate::symbolic::rewrite::Rewriter::new();
        let folded = rewriter.apply(&mut self.graph, e, &mut |g, n| match g.node(n) {
            Node::Var(v) => values.get(&v).copied(),
            _ => None,
        });
        self.graph.as_const(folded)
    }

    /// A leaf of an expression that is no literal: the one that is reached by first operands.
    fn first_leaf(&self, mut e: ExprId) -> ExprId {
        loop {
            let mut next = None;
            self.graph.for_each_operand(e, |a| {
                if next.is_none() && self.graph.as_const(a).is_none() {
                    next = Some(a);
                }
            });
            match next {
                Some(operand) => e = operand,
                None => return e,
            }
        }
    }

    /// False for a node that only a run knows; `reals` says whether Real parameters are known.
    fn may_be_known(&self, n: ExprId, reals: bool) -> bool {
        match self.graph.node(n) {
            Node::Var(v) => {
                let Some(&(id, _)) = self.evaluation.instance_of.get(v.0 as usize) else {
                    return false;
                };
                let kind = &self.instances[id].kind;
                let real = matches!(kind, InstanceKind::Variable { ty: Type::Real, .. });
                (reals || !real) && self.variable_variability(v) <= Variability::Parameter
            }
            Node::Time
            | Node::Der(_)
            | Node::Pre(_)
            | Node::Initial
            | Node::Terminal
            | Node::Sample(..)
            | Node::Call { .. }
            | Node::Recorded(..)
            | Node::Relation(_) => false,
            _ => true,
        }
    }
}
