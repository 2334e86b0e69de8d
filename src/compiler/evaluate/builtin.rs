//! Built-in operators and functions with function syntax (sections 3.7 and 10.3 of the
//! specification).

use super::Evaluator;
use super::cause::array::ArrayCause;
use super::cause::builtin::BuiltinCause;
use super::cause::name::NameCause;
use super::cause::types::{TypeCause, Underived};
use super::connection_operator::GraphRoots;
use super::reference::Selection;
use super::value::Value;
use crate::base::diag::{Diagnostic, did_you_mean};
use crate::base::index::{FastMap, FastSet};
use crate::base::name::Name;
use crate::base::source::Span;
use crate::classes::lookup::Found;
use crate::classes::predefined::{OF_MODELS, is_built_in, without_row};
use crate::classes::unsupported::Construct;
use crate::ir::ast::{ClassKind, ComponentRef, Expr, ExprKind, Ident};
use crate::ir::expr::{Binary, ExprId, Node, Type, Unary, VarId};
use crate::ir::instance::{ClassId, InstanceId, InstanceKind, Scope};
use crate::symbolic::gradient::{Leaf, time_derivative};

/// An argument by its position, counted from 0, or by its name.
pub(crate) fn argument<'e>(
    args: &'e [Expr],
    named: &'e [(Ident, Expr)],
    k: usize,
    name: &str,
) -> Option<&'e Expr> {
    let by_name = || named.iter().find(|(n, _)| n.name == name).map(|(_, e)| e);
    args.get(k).or_else(by_name)
}

/// State of the built-in functions of a model.
#[derive(Default)]
pub struct Builtins {
    /// Names that no function of the user shadows where they were called.
    unshadowed: FastSet<(ClassId, Name)>,
    /// In how many connections each connector is; known once equations are read.
    pub(crate) cardinality: Option<FastMap<InstanceId, usize>>,
    /// The roots of overconstrained connections; known once equations are read.
    pub(crate) graph_roots: Option<GraphRoots>,
    /// The variable that stands for `inStream` of each stream variable.
    pub(crate) in_stream: FastMap<VarId, VarId>,
}

impl Evaluator<'_> {
    /// A call in an expression.
    pub(crate) fn call(
        &mut self,
        function: &ComponentRef,
        args: &[Expr],
        named: &[(Ident, Expr)],
        span: Span,
        scope: Scope,
    ) -> Option<Value> {
        // `.sin` means the built-in where a library defines a `sin` of its own.
        let name = match function.parts.as_slice() {
            [one] if one.subscripts.is_empty() => Some(one.name.name),
            _ => None,
        };
        if let Some(name) = name
            && let Some(Value::Function(f)) = self.local(name)
        {
            return self.call_value(&f, args, named, span, scope);
        }
        if let Some(name) = name
            && (function.global || !self.is_shadowed_builtin(name, scope))
            && let Some(result) = self.builtin(name, args, named, span, scope)
        {
            return result;
        }
        let path = crate::ir::ast::Path {
            global: function.global,
            parts: function.parts.iter().map(|p| p.name).collect(),
            span: function.span,
        };
        let Some(class) = self.find_class(&path, scope) else {
            if let Some(answer) = self.graph_query(function, args, span, scope) {
                return answer;
            }
            if let Some(class) = self.function_of_component(&path, function, scope) {
                return self.call_with(class, args, named, span, scope);
            }
            self.report_unknown_function(&path);
            return None;
        };
        self.report_access_violation();
        self.call_with(class, args, named, span, scope)
    }

    /// A call that stands alone as an equation or statement. Functions may be called for their
    /// assertions; an operator of the language only has a value.
    pub(crate) fn call_alone(&mut self, call: &Expr, scope: Scope) -> Option<()> {
        if let ExprKind::Call { function, .. } = &call.kind
            && let Some(name) = function.simple()
            && self.is_operator(name)
            && !self.is_shadowed_builtin(name, scope)
        {
            self.report(BuiltinCause::UnusedValue { name }, call.span);
            return None;
        }
        self.evaluate_outputs(call, scope).map(|_| ())
    }

    fn is_operator(&self, name: Name) -> bool {
        let is_value = !matches!(name.as_str(), "assert" | "terminate" | "reinit" | "connect");
        is_value && is_built_in(&name)
    }

    /// Whether a function of an enclosing scope shadows the predefined one of its name, which
    /// belongs to the outermost scope (section 5.3.1).
    fn is_shadowed_builtin(&mut self, name: Name, scope: Scope) -> bool {
        let place = (scope.class, name);
        if self.builtins.unshadowed.contains(&place) {
            return false;
        }
        let found = self.find_first(name, scope);
        let hidden = matches!(found, Some(Found::Class(c))
            if matches!(self.kind(c), ClassKind::Function { .. }));
        if !hidden && !self.table_in_progress(scope.class) {
            self.builtins.unshadowed.insert(place);
        }
        hidden
    }

    fn is_operator_of_record(&mut self, holder: InstanceId) -> bool {
        let class = self.instances[holder].class;
        class.is_some_and(|c| self.kind(c) == ClassKind::OperatorRecord)
    }

    /// `a.B.f`, where `a` is a component and all that follows are classes (section 5.3.2).
    fn function_of_component(
        &mut self,
        path: &crate::ir::ast::Path,
        function: &ComponentRef,
        scope: Scope,
    ) -> Option<ClassId> {
        let (first, rest) = path.parts.split_first()?;
        if path.global || rest.is_empty() || self.frames.in_function() {
            return None;
        }
        let mut holder = self.child(scope.instance, first.name)?;
        self.complete(holder);
        if let InstanceKind::Outer(inner) = self.instances[holder].kind {
            holder = inner;
        }
        crate::rules::visibility::check_conditional(self, holder, scope, first.span);
        if matches!(self.instances[holder].kind, InstanceKind::Array { .. })
            || !function.parts[0].subscripts.is_empty()
        {
            self.report(NameCause::FunctionOfArray { name: first.name }, function.span);
        }
        let mut class = self.instances[holder].class?;
        let mut operator = None;
        for part in rest {
            let inner = self.member_class(class, part.name, holder)?;
            if let Some(declared) = self.protected_in(class, part.name) {
                self.report_protected(*part, declared);
            }
            class = inner;
            // A name in quotes is that of an operator, whose functions are called by writing it.
            if part.name.starts_with('\'') {
                operator = operator.or(Some(*part));
            }
        }
        if let Some(operator) = operator.filter(|_| self.is_operator_of_record(holder)) {
            let cause = NameCause::OperatorThroughComponent { operator: operator.name };
            self.report(cause, operator.span);
        }
        matches!(self.kind(class), ClassKind::Function { .. }).then_some(class)
    }

    fn call_with(
        &mut self,
        class: ClassId,
        args: &[Expr],
        named: &[(Ident, Expr)],
        span: Span,
        scope: Scope,
    ) -> Option<Value> {
        let mode = self.mode_of_arguments(class);
        let mut positional = Vec::with_capacity(args.len());
        for a in args {
            positional.push(self.with_mode(mode, |cx| cx.argument(a, scope))?);
        }
        let mut by_name = Vec::with_capacity(named.len());
        for (n, e) in named {
            by_name.push((*n, self.with_mode(mode, |cx| cx.argument(e, scope))?));
        }
        self.call_class(class, positional, by_name, span)
    }

    fn report_unknown_function(&mut self, path: &crate::ir::ast::Path) {
        let name = path.to_string();
        let of_table = Unary::TABLE.iter().flat_map(|op| op.called_names());
        let of_table = of_table.chain(Binary::TABLE.iter().flat_map(|op| op.called_names()));
        let known = of_table.copied().chain(without_row());
        let near = did_you_mean(&name, known).map(str::to_string);
        let cause = NameCause::UnknownFunction { path: name, near };
        self.problems.push(Diagnostic::new(cause, path.span).label("not found"));
    }

    /// `None` if the name is not a built-in function.
    fn builtin(
        &mut self,
        name: Name,
        args: &[Expr],
        named: &[(Ident, Expr)],
        span: Span,
        scope: Scope,
    ) -> Option<Option<Value>> {
        if self.frames.in_function() && OF_MODELS.contains(&name.as_str()) {
            self.report(BuiltinCause::OperatorInFunction { name }, span);
            return Some(None);
        }
        if let Some(op) = Unary::called(&name) {
            return Some(self.unary_call(op, args, span, scope));
        }
        if let Some(op) = Binary::called(&name) {
            return Some(self.binary_call(op, args, span, scope));
        }
        let result = match name.as_str() {
            "der" => self.der(args, span, scope),
            "pre" => self.of_variable(args, span, scope, |cx, v, ty| cx.graph.pre(v, ty)),
            "edge" => self.of_variable(args, span, scope, |cx, v, ty| {
                let (now, before) = (cx.value_now(v, ty), cx.graph.pre(v, ty));
                let not_before = cx.graph.not(before);
                cx.graph.and(now, not_before)
            }),
            "change" => self.of_variable(args, span, scope, |cx, v, ty| {
                let (now, before) = (cx.value_now(v, ty), cx.graph.pre(v, ty));
                cx.graph.binary(Binary::NotEqual, now, before)
            }),
            "initial" | "terminal" if !args.is_empty() || !named.is_empty() => {
                self.wrong_arguments(span, "no arguments");
                None
            }
            "initial" => Some(Value::Scalar(self.graph.intern(Node::Initial, Type::Boolean))),
            "terminal" => Some(Value::Scalar(self.graph.intern(Node::Terminal, Type::Boolean))),
            "sample" => self.sample_call(args, named, span, scope),
            "noEvent" => {
                self.one(args, span, scope).map(|v| v.each_scalar(&mut |e| self.graph.no_event(e)))
            }
            "smooth" => self.smooth_call(args, span, scope),
            "homotopy" => self.homotopy_call(args, named, span, scope),
            "semiLinear" => self.semi_linear(args, span, scope),
            "delay" => self.delay(args, span, scope),
            "spatialDistribution" => self.spatial_distribution(args, named, span, scope),
            "cardinality" => self.cardinality(args, span, scope),
            "inStream" => self.in_stream_call(args, span, scope),
            "actualStream" => self.actual_stream_call(args, span, scope),
            "getInstanceName" if !args.is_empty() || !named.is_empty() => {
                self.wrong_arguments(span, "no arguments");
                None
            }
            "getInstanceName" => self.instance_name(scope),
            "String" => self.string_call(args, named, span, scope),
            "min" | "max" => self.min_max(name.as_str(), args, span, scope),
            "sum" | "product" => {
                self.one(args, span, scope).and_then(|v| self.reduce(name.as_str(), &v, span))
            }
            "size" | "ndims" | "zeros" | "ones" | "fill" | "identity" | "diagonal" | "linspace"
            | "transpose" | "cross" | "skew" | "outerProduct" | "symmetric" | "vector"
            | "scalar" | "matrix" | "cat" | "array" => {
                self.array_call(name.as_str(), args, span, scope)
            }
            "reinit" => {
                self.report(BuiltinCause::ReinitOutsideWhen, span);
                None
            }
            "assert" | "terminate" => {
                self.report(BuiltinCause::CallWithoutValue { name }, span);
                None
            }
            _ => return self.clock_call(name, args, named, span, scope),
        };
        Some(result)
    }

    fn one(&mut self, args: &[Expr], span: Span, scope: Scope) -> Option<Value> {
        match args {
            [a] => self.evaluate(a, scope),
            _ => {
                self.wrong_arguments(span, "one argument");
                None
            }
        }
    }

    /// `sample(start, interval)`; of one argument, or with a clock, it belongs to clocks.
    fn sample_call(
        &mut self,
        args: &[Expr],
        named: &[(Ident, Expr)],
        span: Span,
        scope: Scope,
    ) -> Option<Value> {
        let second = args.get(1).or_else(|| argument(&[], named, 1, "clock"));
        let ([first] | [first, _]) = args else {
            self.wrong_arguments(span, "two arguments");
            return None;
        };
        let value = self.evaluate(first, scope);
        let Some(second) = second else { return Some(self.clocked_sample(&value?, None)) };
        let b = self.evaluate_scalar(second, scope);
        if b.is_some_and(|b| self.graph.ty(b) == Type::Clock) {
            return Some(self.clocked_sample(&value?, b));
        }
        let a = value.and_then(|value| self.scalar_of(value, first.span));
        Some(Value::Scalar(self.graph.intern(Node::Sample(a?, b?), Type::Boolean)))
    }

    fn unary_call(&mut self, op: Unary, args: &[Expr], span: Span, scope: Scope) -> Option<Value> {
        let value = self.one(args, span, scope)?;
        if op == Unary::Ordinal {
            return value.map(|v| {
                let e = self.scalar_of(v.clone(), span)?;
                Some(Value::Scalar(self.graph.unary(op, e)))
            });
        }
        self.each_number(op, &value, span)
    }

    fn binary_call(
        &mut self,
        op: Binary,
        args: &[Expr],
        span: Span,
        scope: Scope,
    ) -> Option<Value> {
        let [a, b] = args else {
            self.wrong_arguments(span, "two arguments");
            return None;
        };
        let (a, b) = (self.evaluate(a, scope)?, self.evaluate(b, scope)?);
        self.each_pair(op, &a, &b, span)
    }

    /// `der(e)`: of a variable its derivative, of anything else the total derivative by time.
    fn der(&mut self, args: &[Expr], span: Span, scope: Scope) -> Option<Value> {
        let value = self.one(args, span, scope)?;
        value.map(|v| {
            let e = self.scalar_of(v.clone(), span)?;
            if self.graph.ty(e) != Type::Real {
                let given = crate::symbolic::print::type_name(&self.graph, self.graph.ty(e));
                let cause = TypeCause::NotDifferentiable { what: Underived::Type(given) };
                self.problems.push(
                    Diagnostic::new(cause, span).label("only Real expressions have derivatives"),
                );
                return None;
            }
            if matches!(self.graph.node(e), Node::Var(_))
                && self.variability(e) == crate::ir::ast::Variability::Discrete
            {
                let cause = TypeCause::NotDifferentiable { what: Underived::Discrete };
                self.problems.push(Diagnostic::new(cause, span).label("changes at events only"));
                return None;
            }
            if let Node::Var(x) = self.graph.node(e)
                && self.variability(e) == crate::ir::ast::Variability::Continuous
            {
                return Some(Value::Scalar(self.graph.der(x)));
            }
            if self.graph.any([e], |_, node| matches!(node, Node::Der(_))) {
                self.unsupported(span, Construct::SecondDerivative);
                return None;
            }
            if self.graph.any([e], |_, node| matches!(node, Node::Call { .. })) {
                return self.derivative_of_calls(e, span).map(Value::Scalar);
            }
            let continuous: Vec<VarId> = self
                .graph
                .variables(e)
                .into_iter()
                .filter(|x| {
                    let read = self.graph.var(*x, Type::Real);
                    self.variability(read) == crate::ir::ast::Variability::Continuous
                })
                .collect();
            let d = time_derivative(&mut self.graph, e, |g, leaf| match leaf {
                Leaf::Var(x) if continuous.contains(&x) => Some(g.der(x)),
                _ => None,
            });
            Some(Value::Scalar(d))
        })
    }

    fn of_variable(
        &mut self,
        args: &[Expr],
        span: Span,
        scope: Scope,
        act: impl Fn(&mut Self, VarId, Type) -> ExprId,
    ) -> Option<Value> {
        let mode = self.mode.unassigned();
        let value = self.with_mode(mode, |cx| cx.one(args, span, scope));
        value?.map(|v| {
            let e = self.scalar_of(v.clone(), span)?;
            self.of_dynamic(e, span, &act).map(Value::Scalar)
        })
    }

    /// A variable as an algorithm section reads it where it is being executed.
    fn value_now(&mut self, v: VarId, ty: Type) -> ExprId {
        match self.assigned.get(&v) {
            Some(assigned) => *assigned,
            None => self.graph.var(v, ty),
        }
    }

    /// As [`Evaluator::of_variable`], for a variable or for one that is selected at run time.
    fn of_dynamic(
        &mut self,
        e: ExprId,
        span: Span,
        act: &impl Fn(&mut Self, VarId, Type) -> ExprId,
    ) -> Option<ExprId> {
        match self.graph.node(e) {
            Node::Var(x) => {
                let ty = self.graph.ty(e);
                Some(act(self, x, ty))
            }
            // A value that never changes equals its `pre` value.
            Node::Const(_) => Some(e),
            Node::If(c, a, b) => {
                let (a, b) = (self.of_dynamic(a, span, act)?, self.of_dynamic(b, span, act)?);
                Some(self.graph.if_then_else(c, a, b))
            }
            _ => {
                let function = self.called_name(span);
                self.report(BuiltinCause::ArgumentNotVariable { function }, span);
                None
            }
        }
    }

    fn smooth_call(&mut self, args: &[Expr], span: Span, scope: Scope) -> Option<Value> {
        let [order, e] = args else {
            self.wrong_arguments(span, "two arguments");
            return None;
        };
        let order = self.fold_size(order, scope)? as u32;
        let value = self.evaluate(e, scope)?;
        value.map(|v| {
            let smoothed = self.number(v, e.span)?;
            Some(Value::Scalar(self.graph.smooth(order, smoothed)))
        })
    }

    fn homotopy_call(
        &mut self,
        args: &[Expr],
        named: &[(Ident, Expr)],
        span: Span,
        scope: Scope,
    ) -> Option<Value> {
        let find = |k: usize, name: &str| argument(args, named, k, name);
        let both = (find(0, "actual"), find(1, "simplified"));
        let ((Some(actual), Some(simplified)), 2) = (both, args.len() + named.len()) else {
            self.wrong_arguments(span, "two arguments");
            return None;
        };
        let values = [actual, simplified].map(|e| self.evaluate(e, scope));
        let [Some(a), Some(b)] = values else { return None };
        for (value, at) in [(&a, actual), (&b, simplified)] {
            for element in value.elements() {
                self.number(element, at.span)?;
            }
        }
        self.each_of([a, b], span, |cx, [a, b]| cx.graph.intern(Node::Homotopy(a, b), Type::Real))
    }

    /// Applies an operator to scalars. With arrays it is called for each element (section 12.4.6).
    fn each_of<const N: usize>(
        &mut self,
        values: [Value; N],
        span: Span,
        act: impl Fn(&mut Self, [ExprId; N]) -> ExprId,
    ) -> Option<Value> {
        let shape = values.iter().find(|v| !v.dims().is_empty());
        let (dims, count) = shape
            .map_or_else(Default::default, |shape| (shape.dims().to_vec(), shape.elements().len()));
        if values.iter().any(|v| !v.dims().is_empty() && v.dims() != dims) {
            self.report(ArrayCause::VectorizedSizes, span);
            return None;
        }
        let scalars = |k: usize| {
            let part =
                |v: &Value| v.elements().get(if v.dims().is_empty() { 0 } else { k })?.scalar();
            let parts: Option<Vec<ExprId>> = values.iter().map(part).collect();
            <[ExprId; N]>::try_from(parts?).ok()
        };
        if dims.is_empty() {
            return Some(Value::Scalar(act(self, scalars(0)?)));
        }
        let mut elements = Vec::with_capacity(count);
        for k in 0..count {
            elements.push(Value::Scalar(act(self, scalars(k)?)));
        }
        Some(Value::array(dims, elements))
    }

    /// `cardinality(c)`: in how many connections the connector is, from inside and outside (section 3.7.4.3).
    fn cardinality(&mut self, args: &[Expr], span: Span, scope: Scope) -> Option<Value> {
        let [Expr { kind: ExprKind::Ref(r), .. }] = args else {
            self.wrong_arguments(span, "one connector");
            return None;
        };
        let n = match self.select(r, scope)? {
            Selection::Whole(mut id) => {
                while let InstanceKind::Outer(inner) = self.instances[id].kind {
                    id = inner;
                }
                let kind = self.instances[id].class.map(|c| self.kind(c));
                if !matches!(kind, Some(ClassKind::Connector | ClassKind::ExpandableConnector)) {
                    self.report(BuiltinCause::CardinalityOfOther, r.span);
                    return None;
                }
                let Some(counts) = &self.builtins.cardinality else {
                    self.unsupported(span, Construct::CardinalityOutsideEquations);
                    return None;
                };
                counts.get(&id).copied().unwrap_or(0)
            }
            Selection::Absent => 0,
            Selection::Element(..) | Selection::Many(..) | Selection::Dynamic(..) => {
                self.unsupported(span, Construct::ArrayCardinality);
                return None;
            }
        };
        Some(Value::Scalar(self.graph.integer(n as i64)))
    }

    /// `getInstanceName()`: the simple name of the model, and the component in hand (section 3.7.4.6).
    fn instance_name(&mut self, scope: Scope) -> Option<Value> {
        let mut top = scope.instance;
        while let Some(around) = self.instances[top].parent {
            top = around;
        }
        let model = self.instances[top].class.map(|c| self.classes[c].full_name);
        let model = model.map(|n| n.rsplit('.').next().unwrap_or_default().to_string());
        let mut text = model.unwrap_or_default();
        let path = self.path(scope.instance);
        if !path.is_empty() && top != scope.instance {
            text.push('.');
            text.push_str(&path);
        }
        Some(Value::Scalar(self.graph.string(&text)))
    }

    /// `semiLinear(x, p, n) = if x >= 0 then p*x else n*x` (section 3.7.4).
    fn semi_linear(&mut self, args: &[Expr], span: Span, scope: Scope) -> Option<Value> {
        let [x, p, n] = args else {
            self.wrong_arguments(span, "three arguments");
            return None;
        };
        let values = [x, p, n].map(|e| self.evaluate(e, scope));
        let [Some(x), Some(p), Some(n)] = values else { return None };
        self.each_of([x, p, n], span, |cx, [x, p, n]| cx.semi_linear_scalar(x, p, n))
    }

    fn semi_linear_scalar(&mut self, x: ExprId, p: ExprId, n: ExprId) -> ExprId {
        let zero = self.graph.real(0.0);
        let c = self.graph.binary(Binary::GreaterEqual, x, zero);
        let (a, b) = (self.graph.mul(p, x), self.graph.mul(n, x));
        let e = self.graph.if_then_else(c, a, b);
        self.graph.smooth(0, e)
    }
}
