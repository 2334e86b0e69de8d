//! Component references: the meaning of a dotted name with subscripts.

use std::rc::Rc;

use super::Evaluator;
use super::cause::array::ArrayCause;
use super::cause::name::NameCause;
use super::cause::types::Expected;
use super::cause::value::ValueCause;
use super::demand::Demand;
use super::mode::Mode;
use super::subscript::Selector;
use super::value::{Record, Value};
use crate::base::diag::Diagnostic;
use crate::base::index::FastMap;
use crate::base::name::Name;
use crate::base::source::Span;
use crate::classes::cause::{Alternatives, ClassCause, Holder, Varying};
use crate::classes::lookup::Found;
use crate::ir::ast::{ComponentRef, ExprKind, Ident, RefPart, Subscript, Variability};
use crate::ir::expr::{Const, ExprId, Type};
use crate::ir::instance::{ClassId, InstanceId, InstanceKind, Scope};

/// The instances that a reference names.
#[derive(Clone, Debug)]
pub enum Selection {
    /// A component as a whole.
    Whole(InstanceId),
    /// One scalar of an array variable, by its position.
    Element(InstanceId, usize),
    /// Several, row-major.
    Many(Vec<usize>, Vec<Selection>),
    /// One of these, by a subscript known only at run time.
    Dynamic(ExprId, Vec<Selection>),
    /// A component whose condition is false.
    Absent,
}

/// Constants with units that are read as plain numbers: their units are not checked.
#[derive(Default)]
pub struct Units {
    /// Whether one was read since this was last asked for.
    pub(crate) unitless_literal: bool,
    /// Whether constants have units.
    has_unit: FastMap<InstanceId, bool>,
}

/// The meaning of the first identifiers of a reference.
enum Start {
    Instance(InstanceId, usize),
    Literal(ExprId),
}

impl Evaluator<'_> {
    /// The value of a reference.
    pub(crate) fn reference(&mut self, r: &ComponentRef, scope: Scope) -> Option<Value> {
        let first = &r.parts[0];
        if !r.global {
            if let Some(value) = self.local(first.name.name) {
                let mut value = self.subscripted(value, &first.subscripts, scope, r.span)?;
                for part in &r.parts[1..] {
                    let Some(field) = value.field(part.name.name) else {
                        self.report_unknown_field(first.name.name, &value, part.name);
                        return None;
                    };
                    let outer = value.dims().len();
                    value =
                        self.subscripted_within(field, outer, &part.subscripts, scope, r.span)?;
                }
                return Some(value);
            }
            if r.simple().is_some_and(|n| n == "time") {
                crate::rules::specialized_class::check_time(self, r.span, scope);
                return Some(Value::Scalar(self.graph.time()));
            }
        }
        match self.start_of(r, scope)? {
            Start::Literal(e) => Some(Value::Scalar(e)),
            Start::Instance(id, used) => {
                self.value_of_parts(id, &r.parts[used - 1..], scope, r.span)
            }
        }
    }

    /// The components that a reference names, also with subscripts known only at run time.
    pub(crate) fn select_target(&mut self, r: &ComponentRef, scope: Scope) -> Option<Selection> {
        match self.start_of(r, scope)? {
            Start::Literal(_) => {
                let found = "a literal of an enumeration";
                self.report(NameCause::NotAVariable { found }, r.span);
                None
            }
            Start::Instance(id, used) => self.walk(id, &r.parts[used - 1..], true, scope, r.span),
        }
    }

    pub(super) fn local(&self, wanted: Name) -> Option<Value> {
        self.frames.find(wanted).cloned()
    }

    /// The instance that the name starts with, and how many of its parts lead to it.
    fn start_of(&mut self, r: &ComponentRef, scope: Scope) -> Option<Start> {
        let first = &r.parts[0];
        if !r.global
            && !self.frames.in_function()
            && let Some(id) = self.visible(scope, first.name.name)
        {
            return Some(Start::Instance(self.outer_of(id), 1));
        }
        let found = if r.global {
            let root = crate::classes::ROOT;
            self.member_class(root.class, first.name.name, root.instance).map(Found::Class)
        } else {
            self.find_first(first.name.name, scope)
        };
        let mut class = match found {
            Some(Found::Component(package, name)) => {
                return self.package_component(package, name).map(|id| Start::Instance(id, 1));
            }
            Some(Found::Class(c)) => c,
            None => {
                self.report_unknown_name(first.name.name, first.name.span, scope);
                return None;
            }
        };
        for (k, part) in r.parts.iter().enumerate().skip(1) {
            let holder = self.classes[class].holder;
            if let Some(c) = self.member_class(class, part.name.name, holder) {
                self.check_step(class, part.name);
                class = c;
            } else if let Some(id) = self.package_component(class, part.name.name) {
                self.check_step(class, part.name);
                self.check_not_partial(class, part.name, scope);
                return Some(Start::Instance(id, k + 1));
            } else {
                return self.literal(class, &part.name).map(Start::Literal);
            }
        }
        let class = self.classes[class].full_name;
        self.report(NameCause::ClassAsValue { class }, r.span);
        None
    }

    /// Elements of a partial class are not accessed from outside (section 5.3.2).
    fn check_not_partial(&mut self, class: ClassId, part: Ident, scope: Scope) {
        let Some(partial) = self.partial_definition(class) else { return };
        let mut around = Some(scope.class);
        while let Some(at) = around {
            if self.definition(at).is_some_and(|t| std::sync::Arc::ptr_eq(t, &partial)) {
                return;
            }
            around = self.classes[at].enclosing;
        }
        if self.from_outside(part.span) {
            return;
        }
        let cause = NameCause::ElementOfPartial { name: part.name, class: partial.name.name };
        self.problems.push(
            Diagnostic::new(cause, part.span).also(partial.name.span, "declared `partial` here"),
        );
    }

    /// The component of the current instance that a name in `scope.class` refers to: elements that
    /// a derived class adds are not visible in it (section 7.1).
    pub(super) fn visible(&mut self, scope: Scope, wanted: Name) -> Option<InstanceId> {
        let id = self.child(scope.instance, wanted)?;
        let own = self.instances[scope.instance].class;
        if own.is_none_or(|own| own == scope.class) || self.table_in_progress(scope.class) {
            return Some(id);
        }
        let of_text = self.table(scope.class);
        if of_text.index.contains_key(&wanted) {
            return Some(id);
        }
        // Variables that connections added to a bus belong to no class.
        let of_instance = self.table_of(scope.instance);
        (!of_instance.index.contains_key(&wanted) || self.is_short(scope.class)).then_some(id)
    }

    fn is_short(&self, class: ClassId) -> bool {
        let short =
            |t: &crate::ir::ast::Class| matches!(t.body, crate::ir::ast::ClassBody::Short(_));
        self.definition(class).is_none_or(|t| short(t))
    }

    fn literal(&mut self, class: ClassId, part: &Ident) -> Option<ExprId> {
        let table = self.table(class);
        let full_name = self.classes[class].full_name;
        let Some(Type::Enumeration(id)) = table.scalar else {
            let names: Vec<String> =
                table.entries.iter().map(|e| e.name.name.to_string()).collect();
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let holder = Holder::Named(full_name.to_string());
            let others = Alternatives::near(part.name, &names);
            let cause = ClassCause::UnknownElement { holder, name: part.name, others };
            self.problems.push(Diagnostic::new(cause, part.span).label("not found"));
            return None;
        };
        let literals = self.graph.enumerations[id].literals.clone();
        if let Some(at) = literals.iter().position(|l| *l == part.name) {
            return Some(self.graph.constant(Const::Enumeration(id, at as u32 + 1)));
        }
        let names: Vec<&str> = literals.iter().map(|l| l.as_str()).collect();
        let (enumeration, others) = (full_name.to_string(), Alternatives::of(part.name, &names));
        let cause = NameCause::UnknownLiteral { enumeration, name: part.name, others };
        self.problems.push(Diagnostic::new(cause, part.span).label("not found"));
        None
    }

    /// The number of values of an enumeration or of `Boolean` named as a size.
    pub(crate) fn type_size(&mut self, r: &ComponentRef, scope: Scope) -> Option<usize> {
        match self.named_type(r, scope)? {
            Type::Boolean => Some(2),
            Type::Enumeration(id) => Some(self.graph.enumerations[id].literals.len()),
            _ => None,
        }
    }

    /// The values of an enumeration or of `Boolean` named as a range.
    pub(crate) fn type_values(&mut self, r: &ComponentRef, scope: Scope) -> Option<Vec<Value>> {
        match self.named_type(r, scope)? {
            Type::Boolean => {
                Some([false, true].map(|b| Value::Scalar(self.graph.boolean(b))).to_vec())
            }
            Type::Enumeration(id) => {
                let n = self.graph.enumerations[id].literals.len() as u32;
                let literal = |k| Const::Enumeration(id, k);
                Some((1..=n).map(|k| Value::Scalar(self.graph.constant(literal(k)))).collect())
            }
            _ => None,
        }
    }

    fn named_type(&mut self, r: &ComponentRef, scope: Scope) -> Option<Type> {
        if r.parts.iter().any(|p| !p.subscripts.is_empty()) {
            return None;
        }
        if !r.global
            && (self.local(r.parts[0].name.name).is_some()
                || (!self.frames.in_function()
                    && self.child(scope.instance, r.parts[0].name.name).is_some()))
        {
            return None;
        }
        let path = crate::ir::ast::Path {
            global: r.global,
            parts: r.parts.iter().map(|p| p.name).collect(),
            span: r.span,
        };
        let class = self.find_class(&path, scope)?;
        self.table(class).scalar
    }

    /// Follows the parts of a reference; the first part belongs to `id` itself, whose subscripts are
    /// dealt with unless they are `open`.
    fn walk(
        &mut self,
        id: InstanceId,
        parts: &[RefPart],
        open: bool,
        scope: Scope,
        span: Span,
    ) -> Option<Selection> {
        self.complete(id);
        let (part, rest) = parts.split_first()?;
        if open && self.mode.reads_value {
            crate::rules::visibility::check_conditional(self, id, scope, part.name.span);
        }
        let subscripts: &[Subscript] = if open { &part.subscripts } else { &[] };
        match self.instances[id].kind.clone() {
            InstanceKind::Outer(inner) => {
                if let Some(next) = rest.first() {
                    crate::rules::visibility::check_outer_member(self, id, &next.name);
                }
                self.walk(inner, parts, open, scope, span)
            }
            InstanceKind::Absent => Some(Selection::Absent),
            InstanceKind::Object(_) => {
                self.no_subscripts(part, subscripts)?;
                let Some(next) = rest.first() else { return Some(Selection::Whole(id)) };
                match self.child(id, next.name.name) {
                    Some(child) => {
                        crate::rules::visibility::check_member(self, id, next.name);
                        let child = self.outer_of(child);
                        self.walk(child, rest, true, scope, span)
                    }
                    None => {
                        self.report_unknown_member(id, &next.name);
                        None
                    }
                }
            }
            InstanceKind::Array { dims, elements } => {
                if subscripts.is_empty() && rest.is_empty() {
                    return Some(Selection::Whole(id));
                }
                self.check_index_types(id, subscripts, scope);
                let selectors = self.selectors(&dims, subscripts, scope, span)?;
                // The subscripts are dealt with: the element follows the rest of the name.
                self.selected(&dims, selectors, &mut |cx, k| {
                    cx.walk(elements[k], parts, false, scope, span)
                })
            }
            InstanceKind::Variable { dims, .. } => {
                if let Some(next) = rest.first() {
                    self.report_unknown_member(id, &next.name);
                    return None;
                }
                if subscripts.is_empty() {
                    return Some(Selection::Whole(id));
                }
                self.check_index_types(id, subscripts, scope);
                let selectors = self.selectors(&dims, subscripts, scope, span)?;
                self.selected(&dims, selectors, &mut |_, k| Some(Selection::Element(id, k)))
            }
            InstanceKind::Pending | InstanceKind::InProgress | InstanceKind::Broken => None,
        }
    }

    /// A dimension that is declared by an enumeration or by `Boolean` is counted by its values, not by
    /// numbers (section 10.5.1).
    fn check_index_types(&mut self, id: InstanceId, subscripts: &[Subscript], scope: Scope) {
        let Some(declaration) = self.instances[id].declaration.clone() else { return };
        let declared_in = self.instances[id].scope;
        let dims = declaration.component().dims.iter().chain(&declaration.clause().type_dims);
        for (dim, subscript) in dims.zip(subscripts) {
            let Subscript::Expr(e) = subscript else { continue };
            if matches!(e.kind, ExprKind::Boolean(_))
                && !matches!(dim, Subscript::Expr(dim) if matches!(dim.kind, ExprKind::Ref(_)))
            {
                let found = Value::Scalar(self.graph.boolean(false));
                self.report_type(Expected::Subscript, &found, e.span);
                continue;
            }
            let Subscript::Expr(dim) = dim else { continue };
            let ExprKind::Ref(name) = &dim.kind else { continue };
            let Some(wanted) = self.named_type(name, declared_in) else { continue };
            if wanted == Type::Integer || matches!(e.kind, ExprKind::End) {
                continue;
            }
            let mode = Mode { reads_value: false, ..self.mode };
            // Its assertions are left out here: it is read once more, for its value.
            let (value, _) = self.collect_assertions(|cx| {
                cx.with_mode(mode, |cx| cx.with_end(0, |cx| cx.evaluate(e, scope)))
            });
            let given = value.and_then(|v| v.elements().first().and_then(Value::scalar));
            let Some(given) = given.map(|e| self.graph.ty(e)).filter(|t| *t != wanted) else {
                continue;
            };
            let found = crate::symbolic::print::type_name(&self.graph, given);
            let index = self.sources.text(dim.span).unwrap_or_default().to_string();
            self.problems.push(
                Diagnostic::new(ArrayCause::SubscriptType { index, found }, e.span)
                    .also(dim.span, "declared here"),
            );
        }
    }

    fn no_subscripts(&mut self, part: &RefPart, subscripts: &[Subscript]) -> Option<()> {
        if subscripts.is_empty() {
            return Some(());
        }
        self.report(ArrayCause::NotAnArray { name: part.name.name }, part.name.span);
        None
    }

    fn value_of_parts(
        &mut self,
        id: InstanceId,
        parts: &[RefPart],
        scope: Scope,
        span: Span,
    ) -> Option<Value> {
        // A variable with a subscript known only at run time is selected by conditions.
        if let [part] = parts
            && !part.subscripts.is_empty()
        {
            self.complete(id);
            if let InstanceKind::Variable { dims, .. } = self.instances[id].kind.clone() {
                self.check_index_types(id, &part.subscripts, scope);
                let selectors = self.selectors(&dims, &part.subscripts, scope, span)?;
                if selectors.iter().any(Selector::is_dynamic) {
                    let whole = self.instance_value(id, span)?;
                    return self.apply(&whole, &selectors, span);
                }
            }
        }
        let mode = self.mode.reading();
        let selection = self.with_mode(mode, |cx| cx.walk(id, parts, true, scope, span));
        self.selection_value(&selection?, span)
    }

    fn selection_value(&mut self, selection: &Selection, span: Span) -> Option<Value> {
        match selection {
            Selection::Whole(id) => self.instance_value(*id, span),
            Selection::Element(id, k) => self.variable_element(*id, *k, span).map(Value::Scalar),
            Selection::Many(dims, all) => {
                let values: Vec<Value> =
                    all.iter().map(|s| self.selection_value(s, span)).collect::<Option<_>>()?;
                let mut dims = dims.clone();
                if let Some(Value::Array(inner)) = values.first() {
                    dims.extend(&inner.dims);
                    let flat = values.iter().flat_map(|v| v.elements().to_vec()).collect();
                    return Some(Value::array(dims, flat));
                }
                Some(Value::array(dims, values))
            }
            Selection::Dynamic(e, all) => {
                let values: Vec<Value> =
                    all.iter().map(|s| self.selection_value(s, span)).collect::<Option<_>>()?;
                self.choose(*e, &values, span)
            }
            Selection::Absent => {
                self.report_absent(span);
                None
            }
        }
    }

    pub(super) fn report_absent(&mut self, span: Span) {
        // That the component has a condition says more than that it is absent.
        let is_conditional = |d: &Diagnostic| {
            let is_near = d.primary.0.file == span.file
                && d.primary.0.start <= span.end
                && span.start <= d.primary.0.end;
            is_near
                && d.is(|cause: &ClassCause| matches!(cause, ClassCause::ConditionalRead { .. }))
        };
        if self.problems.iter().any(is_conditional) {
            return;
        }
        self.problems.push(
            Diagnostic::new(NameCause::AbsentComponent, span)
                .label("its condition is false, or nothing is connected to it")
                .note("a conditional component may occur in `connect` only")
                .note("a variable of an expandable connector exists if a connection reaches it"),
        );
    }

    /// The value of a component as a whole.
    pub(crate) fn instance_value(&mut self, id: InstanceId, span: Span) -> Option<Value> {
        self.complete(id);
        match self.instances[id].kind.clone() {
            InstanceKind::Outer(inner) => self.instance_value(inner, span),
            InstanceKind::Variable { dims, .. } => {
                if let Some(value) = self.known_value(id, span)? {
                    return self.spread(value, &dims, &Rc::from([]), span);
                }
                if dims.is_empty() {
                    return self.variable_element(id, 0, span).map(Value::Scalar);
                }
                let n: usize = dims.iter().product();
                let elements = (0..n)
                    .map(|k| self.variable_element(id, k, span).map(Value::Scalar))
                    .collect::<Option<Vec<_>>>()?;
                Some(Value::array(dims.to_vec(), elements))
            }
            InstanceKind::Object(children) => {
                let mut fields = Vec::with_capacity(children.len());
                for &child in children.iter() {
                    let name = self.instances[child].name;
                    self.complete(child);
                    if !matches!(self.instances[child].kind, InstanceKind::Absent) {
                        fields.push((name, self.instance_value(child, span)?));
                    }
                }
                let class = self.instances[id].class;
                Some(Value::Record(Rc::new(Record { class, fields })))
            }
            InstanceKind::Array { dims, elements } => {
                if elements.iter().any(|e| matches!(self.instances[*e].kind, InstanceKind::Absent))
                {
                    self.report_absent(span);
                }
                let values = elements
                    .iter()
                    .map(|e| self.instance_value(*e, span))
                    .collect::<Option<Vec<_>>>()?;
                Some(Value::array(dims.to_vec(), values))
            }
            InstanceKind::Absent
            | InstanceKind::Broken
            | InstanceKind::Pending
            | InstanceKind::InProgress => None,
        }
    }

    /// The value of a constant, and in the folding mode of a parameter; `Some(None)` where the
    /// variable stands for itself.
    fn known_value(&mut self, id: InstanceId, span: Span) -> Option<Option<Value>> {
        let variability = self.instances[id].prefix.variability;
        let folds = match variability {
            Some(Variability::Constant) => {
                self.units.unitless_literal |= self.has_unit(id);
                true
            }
            Some(Variability::Parameter) => {
                if let Some(constant) = self.mode.constant
                    && !self.mode.sizes
                {
                    self.report_variability(constant, span, Varying::Parameter);
                    return None;
                }
                // Sizes may depend on choices of parameters.
                let ty = match self.instances[id].kind {
                    InstanceKind::Variable { ty, .. } => ty,
                    _ => Type::Real,
                };
                if self.mode.fold && self.is_left_to_initialization(id) {
                    return Some(None);
                }
                self.mode.fold || self.mode.sizes && ty != Type::Real && self.bound(id)
            }
            _ => false,
        };
        if folds {
            return match self.parameter_value(id, span) {
                Some(value) => Some(Some(value)),
                None => {
                    self.report_no_value(id, span);
                    None
                }
            };
        }
        let InstanceKind::Variable { first, ty, .. } = self.instances[id].kind else {
            return None;
        };
        if self.mode.sizes {
            // Structural parameters determine sizes too.
            if variability == Some(Variability::Parameter)
                && ty != Type::Real
                && self.bound(id)
                && let Some(value) = self.parameter_value(id, span)
            {
                return Some(Some(value));
            }
            return Some(Some(self.zero_of_type(ty)));
        }
        if self.mode.fold || first.is_none() {
            let path = self.path(id);
            let declared = self.declared_at(id);
            self.problems.push(
                Diagnostic::new(ValueCause::NotEvaluable { path: Some(path) }, span)
                    .label("needed to fix the structure of the model")
                    .also(declared, "declared here"),
            );
            return None;
        }
        Some(None)
    }

    /// Whether a Real parameter has no value of any kind, but equations of the initialization determine it. It stands for
    /// itself: external objects move with it, and what needs a number says so.
    fn is_left_to_initialization(&mut self, id: InstanceId) -> bool {
        let InstanceKind::Variable { ty: Type::Real, first: Some(_), .. } = self.instances[id].kind
        else {
            return false;
        };
        let literal = |cx: &mut Self, of: &str| cx.attribute(id, crate::base::name::name(of));
        let is_open = literal(self, "fixed")
            .is_some_and(|fixed| matches!(fixed.value.kind, ExprKind::Boolean(false)));
        is_open && !self.bound(id) && literal(self, "start").is_none()
    }

    /// Evaluates something; whether it reads a constant with a unit as a plain number.
    pub(crate) fn with_unitless_literals<T>(
        &mut self,
        act: impl FnOnce(&mut Self) -> T,
    ) -> (T, bool) {
        let around = std::mem::take(&mut self.units.unitless_literal);
        let result = act(self);
        (result, std::mem::replace(&mut self.units.unitless_literal, around))
    }

    /// Whether a Real constant is declared with a unit.
    fn has_unit(&mut self, id: InstanceId) -> bool {
        if !matches!(self.instances[id].kind, InstanceKind::Variable { ty: Type::Real, .. }) {
            return false;
        }
        if let Some(known) = self.units.has_unit.get(&id) {
            return *known;
        }
        let unit = self.attribute(id, crate::base::name::name("unit"));
        let found = unit.is_some_and(
            |b| !matches!(&b.value.kind, ExprKind::String(s) if s.is_empty() || &**s == "1"),
        );
        self.units.has_unit.insert(id, found);
        found
    }

    /// A parameter that depends on itself has no value; other causes were reported before.
    fn report_no_value(&mut self, id: InstanceId, span: Span) {
        if self.problems.has_errors() {
            return;
        }
        let path = self.path(id);
        self.class_graph.problems.push(
            Diagnostic::new(ValueCause::ValueCycle { path }, span)
                .also(self.declared_at(id), "declared here"),
        );
    }

    fn variable_element(&mut self, id: InstanceId, k: usize, span: Span) -> Option<ExprId> {
        if let Some(value) = self.known_value(id, span)? {
            let InstanceKind::Variable { dims, .. } = self.instances[id].kind.clone() else {
                return None;
            };
            let value = self.spread(value, &dims, &Rc::from([]), span)?;
            return value.elements().get(k)?.scalar();
        }
        let InstanceKind::Variable { ty, first: Some(first), .. } = self.instances[id].kind else {
            return None;
        };
        let v = crate::ir::expr::VarId(first.0 + k as u32);
        if !self.mode.unassigned
            && let Some(assigned) = self.assigned.get(&v)
        {
            return Some(*assigned);
        }
        Some(self.graph.var(v, ty))
    }
}

/// One of one, or several.
pub(super) fn many(dims: Vec<usize>, mut all: Vec<Selection>) -> Selection {
    if dims.is_empty() && all.len() == 1 { all.remove(0) } else { Selection::Many(dims, all) }
}
