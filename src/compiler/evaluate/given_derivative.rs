//! Functions of `time` whose annotation gives their derivative, with arguments that are not to be differentiated
//! (`derivative(noDerivative = u) = f_der`, section 12.7.1 of the specification).
//!
//! `s = position(u, time)` moves along the signal `u[1]` with the velocity `u[2]`, whether or not that is the
//! derivative of the signal. Where the other arguments vary in another way, as in the functions of media, those
//! without derivative depend on them, and the derivative of the body has the same value.

use super::Evaluator;
use super::history::Synthetic;
use super::value::Value;
use crate::base::name::Name;
use crate::base::source::Span;
use crate::ir::ast::{Argument, ArgumentKind, Expr, ExprKind, Modification, Path, Variability};
use crate::ir::expr::{ExprId, FIRST_SYMBOL, Node, Type, VarId};
use crate::ir::instance::{ClassId, Declaration, Entry, Scope};

/// What the annotation of a function says of its derivative.
struct GivenDerivative {
    /// The function that computes the derivative.
    function: ClassId,
    /// The order of the derivative.
    order: i64,
    /// Inputs that are not to be differentiated.
    without: Vec<Name>,
    /// Inputs that must not vary.
    constant: Vec<Name>,
}

impl Evaluator<'_> {
    /// The value of a call as a variable whose derivative is that of the annotation; the value itself if the annotation
    /// does not give one.
    pub(super) fn with_given_derivative(
        &mut self,
        class: ClassId,
        inputs: &[&(Entry, Declaration)],
        given: &[Option<Value>],
        value: Value,
        span: Span,
    ) -> Option<Value> {
        // Nearly all calls have no such argument.
        let is_time =
            |v: &Value| matches!(v, Value::Scalar(e) if self.graph.node(*e) == Node::Time);
        let has_time = given.iter().flatten().any(is_time);
        if !has_time || self.frames.in_function() || self.mode.is_before_simulation() {
            return Some(value);
        }
        let Some(first) = self.derivative_annotation(class, 1) else { return Some(value) };
        let Some(varying) = self.varying_arguments(&first, inputs, given) else {
            return Some(value);
        };
        let mut orders = vec![value];
        let mut args: Vec<Value> = given.iter().flatten().cloned().collect();
        let mut next = Some(first);
        for order in 1.. {
            let Some(annotation) = next else { break };
            for argument in &varying {
                let rate = |cx: &mut Self, e| {
                    let moves = order == 1 && cx.graph.node(e) == Node::Time;
                    cx.graph.real(if moves { 1.0 } else { 0.0 })
                };
                args.push(argument.each_scalar(&mut |e| rate(self, e)));
            }
            orders.push(self.call_class(annotation.function, args.clone(), Vec::new(), span)?);
            next = self.derivative_annotation(annotation.function, order + 1);
        }
        Some(self.variables_with_derivatives(&orders, span))
    }

    /// The arguments that have a derivative, if these are `time` and parameters, so that only `time` makes the function
    /// move as far as its annotation is concerned.
    fn varying_arguments(
        &self,
        annotation: &GivenDerivative,
        inputs: &[&(Entry, Declaration)],
        given: &[Option<Value>],
    ) -> Option<Vec<Value>> {
        let mut varying = Vec::new();
        let mut moves = false;
        for ((entry, _), value) in inputs.iter().zip(given) {
            let name = entry.name.name;
            let value = value.as_ref()?;
            let mut scalars = Vec::new();
            value.for_each_scalar(&mut |e| scalars.push(e));
            let in_loop =
                |n: &ExprId| matches!(self.graph.node(*n), Node::Var(v) if v.0 >= FIRST_SYMBOL);
            if self.graph.postorder(scalars.iter().copied()).iter().any(in_loop) {
                return None;
            }
            if annotation.without.contains(&name) {
                continue;
            }
            let is_constant = scalars.iter().all(|e| self.is_fixed(*e));
            let is_time = scalars.iter().all(|e| self.graph.node(*e) == Node::Time);
            if !is_constant && (!is_time || annotation.constant.contains(&name)) {
                return None;
            }
            moves |= !is_constant;
            let is_real = scalars.iter().all(|e| self.graph.ty(*e) == Type::Real);
            if is_real && !annotation.constant.contains(&name) {
                varying.push(value.clone());
            }
        }
        moves.then_some(varying)
    }

    fn is_fixed(&self, e: ExprId) -> bool {
        self.variability(e) <= Variability::Parameter
    }

    /// Variables for the scalars of a value, given with its derivatives in their order.
    fn variables_with_derivatives(&mut self, orders: &[Value], span: Span) -> Value {
        let scalars = |value: &Value| {
            let mut scalars = Vec::new();
            value.for_each_scalar(&mut |e| scalars.push(e));
            scalars
        };
        let columns: Vec<Vec<ExprId>> = orders.iter().map(scalars).collect();
        let is_real = |e: &ExprId| self.graph.ty(*e) == Type::Real;
        let fits = |column: &Vec<ExprId>| column.len() == columns[0].len();
        if !(columns.iter().all(fits) && columns.iter().flatten().all(is_real)) {
            return orders[0].clone();
        }
        let mut scalars = 0..;
        orders[0].each_scalar(&mut |e| {
            let Some(k) = scalars.next() else { return e };
            let derivative = columns.iter().rev().fold(None, |derivative, column| {
                Some(self.variable_with_derivative(column[k], derivative, span))
            });
            derivative.map_or(e, |v| self.graph.var(v, Type::Real))
        })
    }

    fn variable_with_derivative(
        &mut self,
        value: ExprId,
        derivative: Option<VarId>,
        span: Span,
    ) -> VarId {
        let same = |m: &Synthetic| matches!(m, Synthetic::Given(v, d, _) if (*v, *d) == (value, derivative));
        match self.history.synthetic.iter().position(same) {
            Some(k) => self.synthetic_variable(k),
            None => self.make(Synthetic::Given(value, derivative, span)),
        }
    }

    /// The annotation of a function that gives the derivative of this order and names inputs without derivative.
    fn derivative_annotation(&mut self, class: ClassId, order: i64) -> Option<GivenDerivative> {
        let annotation = self.definition(class)?.annotation.clone()?;
        if self.table(class).external.is_some() {
            return None;
        }
        let scope = Scope { instance: self.classes[class].holder, class };
        let mut all = annotation.args.iter();
        all.find_map(|argument| {
            let (name, modification) = element(argument)?;
            let given = match name.as_str() {
                "derivative" => self.read_derivative(modification, scope),
                _ => None,
            };
            given.filter(|g| g.order == order && !g.without.is_empty())
        })
    }

    fn read_derivative(
        &mut self,
        modification: &Modification,
        scope: Scope,
    ) -> Option<GivenDerivative> {
        let ExprKind::Ref(function) = &modification.binding.as_ref()?.kind else { return None };
        let path = Path {
            global: function.global,
            parts: function.parts.iter().map(|part| part.name).collect(),
            span: function.span,
        };
        let function = self.find_class(&path, scope)?;
        let mut given =
            GivenDerivative { function, order: 1, without: Vec::new(), constant: Vec::new() };
        for argument in &modification.args {
            let Some((name, modification)) = element(argument) else { continue };
            let value = modification.binding.as_deref();
            match name.as_str() {
                "order" => given.order = value.and_then(integer)?,
                "noDerivative" => given.without.push(value.and_then(input)?),
                "zeroDerivative" => given.constant.push(value.and_then(input)?),
                _ => {}
            }
        }
        Some(given)
    }
}

fn element(argument: &Argument) -> Option<(Name, &Modification)> {
    match &argument.kind {
        ArgumentKind::Element { path, modification: Some(m), .. } => match path.parts.as_slice() {
            [one] => Some((one.name, m)),
            _ => None,
        },
        _ => None,
    }
}

fn input(e: &Expr) -> Option<Name> {
    match &e.kind {
        ExprKind::Ref(name) => name.simple(),
        _ => None,
    }
}

fn integer(e: &Expr) -> Option<i64> {
    match &e.kind {
        ExprKind::Integer(order) => Some(*order),
        _ => None,
    }
}
