//! The values of variables: from declarations, from modifications, or as parts of the value of the
//! enclosing record or array (section 7.2 of the specification).

use std::rc::Rc;

use super::Evaluator;
use super::cause::array::ArrayCause;
use super::cause::name::NameCause;
use super::cause::value::ValueCause;
use super::frame::FrameKind;
use super::function;
use super::value::Value;
use crate::base::diag::Diagnostic;
use crate::base::index::FastMap;
use crate::base::name::Name;
use crate::base::source::Span;
use crate::classes::cause::Alternatives;
use crate::ir::ast::{Expr, ExprKind, Variability};
use crate::ir::expr::{Const, Type};
use crate::ir::instance::{InstanceId, InstanceKind, Scope};
use crate::ir::modification::{Binding, Layer};

/// Values that were found before the model is simulated.
#[derive(Default)]
pub struct ParameterValues {
    /// Values of parameters that were asked for; `None` for one without a value.
    pub(crate) values: FastMap<InstanceId, Option<Value>>,
    /// Parameters whose values have fixed the structure.
    pub(crate) structural: Vec<InstanceId>,
    /// Values of bindings that several components share, by expression, scope and mode.
    bindings: FastMap<(usize, Scope, bool), Option<Value>>,
}

impl Evaluator<'_> {
    /// The value of a parameter or constant; reported if it has none.
    pub(crate) fn parameter_value(&mut self, id: InstanceId, span: Span) -> Option<Value> {
        if let Some(known) = self.parameters.values.get(&id) {
            return known.clone();
        }
        // A parameter that is asked for again before it has a value depends on itself.
        self.parameters.values.insert(id, None);
        let is_constant = self.instances[id].prefix.variability == Some(Variability::Constant);
        let mode = self.mode.of_parameter(is_constant.then_some(id));
        let mut value = self.with_mode(mode, |cx| {
            cx.with_frame(FrameKind::Class, |cx| match cx.binding_value(id) {
                None if cx.binding(id).is_none() => cx.start_or_children(id, span),
                value => value,
            })
        });
        if let InstanceKind::Variable { ty: Type::Real, .. } = self.instances[id].kind
            && let Some(found) = &value
        {
            let real = found.each_scalar(&mut |e| self.graph.as_real(e));
            value = Some(real);
        }
        self.parameters.values.insert(id, value.clone());
        self.parameters.structural.push(id);
        value
    }

    /// A parameter without a binding: its start value, or the values of its components.
    pub(super) fn start_or_children(&mut self, id: InstanceId, span: Span) -> Option<Value> {
        self.complete(id);
        match self.instances[id].kind.clone() {
            InstanceKind::Variable { ty, dims, .. } => {
                if let Some(start) = self.attribute(id, crate::base::name::name("start")) {
                    let value = self.evaluate(&start.value, start.scope)?;
                    return self.spread(value, &dims, &start.subscripts, start.value.span);
                }
                let path = self.path(id);
                let declared = self.declared_at(id);
                let kind = match self.instances[id].prefix.variability {
                    Some(Variability::Constant) => Variability::Constant,
                    _ => Variability::Parameter,
                };
                self.problems.push(
                    Diagnostic::new(ValueCause::NoValue { kind, path }, span)
                        .label("needed here before simulation")
                        .also(declared, "declared here"),
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
        let parts = self.bindings_of_elements(id);
        match parts.is_empty() {
            true => self.whole_value(id),
            false => self.with_elements(id, &parts),
        }
    }

    /// The value of an array of which some elements, or rows, have values of their own.
    fn with_elements(&mut self, id: InstanceId, parts: &[(Vec<usize>, Binding)]) -> Option<Value> {
        let InstanceKind::Variable { ty, dims, .. } = self.instances[id].kind.clone() else {
            return self.whole_value(id);
        };
        let span = self.declared_at(id);
        let none = self.no_sizes.clone();
        let whole = match self.bound_as_whole(id) {
            true => self.whole_value(id)?,
            false => self.start_or_children(id, span)?,
        };
        let whole = self.spread(whole, &dims, &none, span)?;
        let mut elements = whole.elements().to_vec();
        for (subscripts, binding) in parts {
            let inner = &dims[subscripts.len()..];
            let size: usize = inner.iter().product();
            let value = self.cached(&binding.value, binding.scope, false, id)?;
            let value = self.spread(value, inner, &none, binding.value.span)?;
            let at = subscripts.iter().zip(dims.iter()).fold(0, |at, (k, n)| at * n + k - 1);
            let slots = elements.iter_mut().skip(at * size);
            slots.zip(value.elements()).for_each(|(slot, new)| *slot = new.clone());
        }
        let made = Value::array(dims.to_vec(), elements);
        Some(match ty {
            Type::Real => made.each_scalar(&mut |e| self.graph.as_real(e)),
            _ => made,
        })
    }

    /// Whether the instance as a whole, or a record around it, has a binding.
    fn bound_as_whole(&self, id: InstanceId) -> bool {
        self.binding(id).is_some() || self.instances[id].parent.is_some_and(|p| self.bound(p))
    }

    fn whole_value(&mut self, id: InstanceId) -> Option<Value> {
        if let Some(binding) = self.binding(id).filter(|_| !self.is_overridden(id)) {
            // A record is asked for by each of its fields.
            let record = matches!(self.instances[id].kind, InstanceKind::Object(_));
            let keep = !binding.subscripts.is_empty() || (record && self.assigned.is_empty());
            let value = self.cached(&binding.value, binding.scope, keep, id)?;
            let dims = binding.subscripts.clone();
            if !binding.setting {
                self.check_extent(id, &value, &dims, binding.value.span);
            }
            return self.element_value(value, &dims, binding.setting, binding.value.span);
        }
        let parent = self.instances[id].parent?;
        if !self.bound(parent) {
            return None;
        }
        match self.instances[parent].kind {
            InstanceKind::Object(_) => {
                let name = self.instances[id].name;
                if let Some(field) = self.field_referred_to(parent, name) {
                    return self.instance_value(field, self.declared_at(id));
                }
                self.binding_value(parent)?.field(name)
            }
            InstanceKind::Array { .. } => {
                let subscripts = self.instances[id].subscripts.clone();
                self.binding_value(parent)?.select(&subscripts)
            }
            _ => None,
        }
    }

    /// True if the binding of an enclosing record comes from further outside than that of the
    /// instance: the record as a whole then overrides the fields of its class (section 7.2.4).
    pub(super) fn is_overridden(&self, id: InstanceId) -> bool {
        // A constant with a value is not a field that a constructor could set.
        if self.instances[id].declaration.as_ref().is_some_and(function::is_constant) {
            return false;
        }
        let mut path = Vec::new();
        let mut around = Vec::new();
        let mut at = id;
        while let Some(parent) = self.instances[at].parent {
            match self.instances[parent].kind {
                InstanceKind::Object(_) => {
                    path.push(self.instances[at].name);
                    if self.instances[parent].layers.iter().any(Layer::binds) {
                        around.push((parent, path.len()));
                    }
                }
                // An element follows its array.
                InstanceKind::Array { .. } => {}
                _ => break,
            }
            at = parent;
        }
        // Modifications of an outer component come from further outside than those of an inner one.
        for (holder, depth) in around.into_iter().rev() {
            for layer in self.instances[holder].layers.iter() {
                if binds_below(layer, &path[..depth]) {
                    return false;
                }
                if layer.binds() {
                    return true;
                }
            }
        }
        false
    }

    /// True if the instance or a record around it has a binding.
    pub fn bound(&self, id: InstanceId) -> bool {
        if self.instances[id].layers.iter().any(Layer::binds) {
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

    pub(super) fn cached(
        &mut self,
        e: &std::sync::Arc<Expr>,
        scope: Scope,
        keep: bool,
        target: InstanceId,
    ) -> Option<Value> {
        let key = (std::sync::Arc::as_ptr(e) as usize, scope, self.mode.fold);
        let keep = keep && !self.mode.sizes;
        if keep && let Some(known) = self.parameters.bindings.get(&key) {
            return known.clone();
        }
        let value = self.with_frame(FrameKind::Class, |cx| match cx.bare_literal(e, target) {
            Some(literal) => literal,
            None => cx.evaluate(e, scope),
        });
        if keep {
            self.parameters.bindings.insert(key, value.clone());
        }
        value
    }

    /// A setting from outside may name an enumeration literal without its type. `Some(None)` if the
    /// type has no such literal, which is reported.
    pub(super) fn bare_literal(&mut self, e: &Expr, target: InstanceId) -> Option<Option<Value>> {
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
        let (enumeration, others) = (ty.name.to_string(), Alternatives::of(wanted, &names));
        self.report(NameCause::UnknownLiteral { enumeration, name: wanted, others }, e.span);
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
            let (given, wanted) = (found.to_vec(), Some(wanted.to_vec()));
            self.report(ArrayCause::ElementModifierSize { given, wanted }, span);
        }
    }

    /// The part of a value for one element of an array of components.
    pub(super) fn element_value(
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
        let given = value.dims().to_vec();
        self.report(ArrayCause::ElementModifierSize { given, wanted: None }, span);
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
        let value = self.element_or_whole(value, subscripts);
        if value.dims() == dims {
            return Some(value);
        }
        if value.dims().is_empty() {
            let n: usize = dims.iter().product();
            return Some(Value::array(dims.to_vec(), vec![value; n]));
        }
        let (declared, given) = (dims.to_vec(), value.dims().to_vec());
        self.report(ArrayCause::BindingSize { variable: None, declared, given }, span);
        None
    }

    pub(super) fn element_or_whole(&self, value: Value, subscripts: &[usize]) -> Value {
        if value.dims().is_empty() {
            return value;
        }
        value.select(subscripts).unwrap_or(value)
    }
}

/// Whether a modification of a component binds the one to which this path leads, from its end on.
fn binds_below(layer: &Layer, path: &[Name]) -> bool {
    let mut layers = vec![layer.clone()];
    for name in path.iter().rev() {
        let mut below = Vec::new();
        layers.iter().for_each(|layer| layer.child(*name, &mut below));
        layers = below;
        if layers.is_empty() {
            return false;
        }
    }
    // An element is not the whole.
    layers.iter().any(|layer| layer.binds() && layer.part().is_none())
}
