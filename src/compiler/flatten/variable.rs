//! Flat variables: numbers in order of declaration, attributes, bindings.

use std::rc::Rc;

use super::cause::FlattenCause;
use crate::base::diag::Diagnostic;
use crate::base::name::{Name, name};
use crate::base::source::Span;
use crate::classes::attribute::is_within;
use crate::classes::cause::Varying;
use crate::classes::subscript_text;
use crate::evaluate::Evaluator;
use crate::evaluate::cause::array::ArrayCause;
use crate::evaluate::cause::types::{Expected, TypeCause};
use crate::evaluate::random_draw::Place;
use crate::evaluate::value::Value;
use crate::evaluate::value::advance;
use crate::ir::ast::Variability;
use crate::ir::expr::{Const, ExprId, Type, VarId};
use crate::ir::flat::{FlatModel, StateSelect, Variable};
use crate::ir::instance::{InstanceId, InstanceKind};

/// Access to the field of a variable that holds an attribute.
type AttributeField<T> = fn(&mut Variable) -> &mut T;

/// Numbers all scalar variables, depth first.
pub fn number(cx: &mut Evaluator<'_>, root: InstanceId, flat: &mut FlatModel) {
    let mut stack: Vec<(InstanceId, Rc<str>)> = vec![(root, Rc::from(""))];
    while let Some((id, path)) = stack.pop() {
        let own = own_path(cx, id, &path);
        match cx.instances[id].kind.clone() {
            InstanceKind::Object(parts) | InstanceKind::Array { elements: parts, .. } => {
                let own: Rc<str> = own.into();
                stack.extend(parts.iter().rev().map(|part| (*part, own.clone())));
            }
            InstanceKind::Variable { ty, dims, .. } => {
                let elements = dims.iter().fold(1_usize, |n, d| n.saturating_mul(*d));
                let (before, most) = (cx.instance_of.len(), cx.budget.size);
                if before.saturating_add(elements) > most {
                    cx.budget.exhausted = true;
                    let path = cx.path(id);
                    let cause = FlattenCause::TooManyVariables { path, before, elements, most };
                    let span = cx.declared_at(id);
                    cx.problems.push(Diagnostic::new(cause, span).label("declared here"));
                    return;
                }
                let first = flat.variables.next_id();
                let mut subscripts = vec![1; dims.len()];
                for k in 0..dims.iter().product() {
                    let text = if dims.is_empty() {
                        own.clone()
                    } else {
                        format!("{own}{}", subscript_text(&subscripts))
                    };
                    flat.variables.push(declared(cx, id, ty, text, root));
                    cx.instance_of.push((id, k));
                    advance(&mut subscripts, &dims);
                }
                if let InstanceKind::Variable { first: slot, .. } = &mut cx.instances[id].kind {
                    *slot = Some(first);
                }
            }
            _ => {}
        }
    }
}

fn own_path(cx: &Evaluator<'_>, id: InstanceId, parent: &str) -> String {
    let instance = &cx.instances[id];
    if !instance.subscripts.is_empty() {
        return [parent, &subscript_text(&instance.subscripts)].concat();
    }
    match (parent.is_empty(), instance.name.is_empty()) {
        (_, true) => parent.to_string(),
        (true, false) => instance.name.to_string(),
        (false, false) => [parent, ".", instance.name.as_str()].concat(),
    }
}

/// Adds a variable that the compiler introduces, such as a delayed expression.
pub fn add_synthetic(flat: &mut FlatModel, name: String, ty: Type, span: Span) -> VarId {
    let slowest = if ty == Type::Real { Variability::Continuous } else { Variability::Discrete };
    let variable = Variable::bare(name, ty, slowest, span);
    let id = flat.variables.push(Variable { protected: true, ..variable });
    flat.synthetic.push(id);
    id
}

/// A variable with the prefixes of its declaration, without attributes.
fn declared(
    cx: &Evaluator<'_>,
    id: InstanceId,
    ty: Type,
    text: String,
    root: InstanceId,
) -> Variable {
    let instance = &cx.instances[id];
    let component = instance.declaration.as_ref().map(|d| d.component());
    let slowest = if ty == Type::Real { Variability::Continuous } else { Variability::Discrete };
    let at_top = instance.parent == Some(root);
    let variability = instance.prefix.variability.unwrap_or(slowest).min(slowest);
    let span = component.map_or(Span::NONE, |c| c.name.span);
    Variable {
        causality: if at_top { instance.prefix.causality } else { None },
        description: component.and_then(|c| c.description.clone()),
        protected: instance.protected,
        structural: instance.declaration.as_ref().is_some_and(|d| d.element.is_final),
        ..Variable::bare(text, ty, variability, span)
    }
}

/// Evaluates attributes and bindings of all variables.
pub fn fill(cx: &mut Evaluator<'_>, flat: &mut FlatModel) {
    let names = AttributeNames::default();
    let mut at = 0;
    while at < cx.instance_of.len() {
        let (id, _) = cx.instance_of[at];
        let InstanceKind::Variable { ty, dims, .. } = cx.instances[id].kind.clone() else {
            unreachable!("only variables are numbered");
        };
        let count: usize = dims.iter().product();
        let first = VarId(at as u32);
        attributes(cx, flat, id, first, (ty, &dims), &names);
        binding(cx, flat, id, first, ty, &dims);
        at += count;
    }
}

/// The names of attributes, looked up once.
struct AttributeNames {
    start: Name,
    min: Name,
    max: Name,
    nominal: Name,
    fixed: Name,
    unit: Name,
    display_unit: Name,
    state_select: Name,
}

impl Default for AttributeNames {
    fn default() -> Self {
        AttributeNames {
            start: name("start"),
            min: name("min"),
            max: name("max"),
            nominal: name("nominal"),
            fixed: name("fixed"),
            unit: name("unit"),
            display_unit: name("displayUnit"),
            state_select: name("stateSelect"),
        }
    }
}

fn attributes(
    cx: &mut Evaluator<'_>,
    flat: &mut FlatModel,
    id: InstanceId,
    first: VarId,
    (ty, dims): (Type, &Rc<[usize]>),
    names: &AttributeNames,
) {
    let given = cx.attributes_given(id);
    if given.is_empty() {
        return;
    }
    let value = |cx: &mut Evaluator<'_>, attribute: Name, fold: bool| -> Option<(Value, Span)> {
        if !given.contains(&attribute) {
            return None;
        }
        let binding = cx.attribute(id, attribute)?;
        let span = binding.value.span;
        let value = if fold {
            cx.fold(&binding.value, binding.scope)?
        } else {
            cx.evaluate(&binding.value, binding.scope)?
        };
        cx.check_extent(id, &value, &binding.subscripts, span);
        Some((cx.spread(value, dims, &binding.subscripts, span)?, span))
    };
    let numeric: [(Name, AttributeField<Option<ExprId>>); 4] = [
        (names.start, |v| &mut v.start),
        (names.min, |v| &mut v.min),
        (names.max, |v| &mut v.max),
        (names.nominal, |v| &mut v.nominal),
    ];
    for (text, slot) in numeric {
        let Some((all, span)) = value(cx, text, false) else { continue };
        let mut scalars = all.elements().iter().filter_map(Value::scalar);
        if scalars.any(|e| cx.variability(e) > Variability::Parameter) {
            cx.report_moving_attribute(id, text, span);
            continue;
        }
        for (k, e) in all.elements().iter().enumerate() {
            let v = VarId(first.0 + k as u32);
            let Some(e) = e.scalar() else { continue };
            let e = converted(cx, e, ty, span, &text);
            *slot(&mut flat.variables[v]) = e;
        }
    }
    if let Some((all, span)) = value(cx, names.fixed, true) {
        for (k, e) in all.elements().iter().enumerate() {
            let e = e.scalar().and_then(|e| converted(cx, e, Type::Boolean, span, &names.fixed));
            let constant = e.and_then(|e| cx.graph.as_const(e));
            let fixed = match constant {
                Some(Const::Boolean(b)) => Some(b),
                _ => None,
            };
            flat.variables[VarId(first.0 + k as u32)].fixed = fixed;
        }
    }
    // Overrides of elements come after what is said of all.
    for (text, slot) in numeric.into_iter().filter(|(text, _)| given.contains(text)) {
        for (v, e, span) in of_elements(cx, id, first, dims, text) {
            *slot(&mut flat.variables[v]) = converted(cx, e, ty, span, &text);
        }
    }
    if given.contains(&names.fixed) {
        for (v, e, span) in of_elements(cx, id, first, dims, names.fixed) {
            let e = converted(cx, e, Type::Boolean, span, &names.fixed);
            if let Some(Const::Boolean(b)) = e.and_then(|e| cx.graph.as_const(e)) {
                flat.variables[v].fixed = Some(b);
            }
        }
    }
    let strings: [(Name, AttributeField<Name>); 2] =
        [(names.unit, |v| &mut v.unit), (names.display_unit, |v| &mut v.display_unit)];
    for (text, slot) in strings {
        let Some((all, span)) = value(cx, text, true) else { continue };
        for (k, e) in all.elements().iter().enumerate() {
            let e = e.scalar().and_then(|e| converted(cx, e, Type::String, span, &text));
            if let Some(Const::String(s)) = e.and_then(|e| cx.graph.as_const(e)) {
                *slot(&mut flat.variables[VarId(first.0 + k as u32)]) = s;
            }
        }
    }
    if let Some((all, _)) = value(cx, names.state_select, true) {
        for (k, e) in all.elements().iter().enumerate() {
            if let Some(Const::Enumeration(_, n)) = e.scalar().and_then(|e| cx.graph.as_const(e)) {
                flat.variables[VarId(first.0 + k as u32)].state_select = match n {
                    1 => StateSelect::Never,
                    2 => StateSelect::Avoid,
                    4 => StateSelect::Prefer,
                    5 => StateSelect::Always,
                    _ => StateSelect::Default,
                };
            }
        }
    }
}

/// The values of an attribute that overrides give to elements of an array, as `x[2].start=5` does.
fn of_elements(
    cx: &mut Evaluator<'_>,
    id: InstanceId,
    first: VarId,
    dims: &Rc<[usize]>,
    attribute: Name,
) -> Vec<(VarId, ExprId, Span)> {
    let mut found = Vec::new();
    for (subscripts, binding) in cx.attributes_of_elements(id, attribute) {
        if !is_within(&subscripts, dims) {
            continue;
        }
        let span = binding.value.span;
        let inner: Rc<[usize]> = dims[subscripts.len()..].into();
        let size: usize = inner.iter().product();
        let at = subscripts.iter().zip(dims.iter()).fold(0, |at, (k, n)| at * n + k - 1);
        let Some(value) = cx.fold(&binding.value, binding.scope) else { continue };
        let none = cx.no_sizes.clone();
        let Some(value) = cx.spread(value, &inner, &none, span) else { continue };
        for (k, e) in value.elements().iter().enumerate() {
            let Some(e) = e.scalar() else { continue };
            found.push((VarId(first.0 + (at * size + k) as u32), e, span));
        }
    }
    found
}

fn binding(
    cx: &mut Evaluator<'_>,
    flat: &mut FlatModel,
    id: InstanceId,
    first: VarId,
    ty: Type,
    dims: &Rc<[usize]>,
) {
    if !cx.bound(id) {
        return;
    }
    let span = cx.binding(id).map_or_else(|| cx.declared_at(id), |b| b.value.span);
    // Constants, and parameters that have fixed the structure, are already evaluated.
    let constant = cx.instances[id].prefix.variability == Some(Variability::Constant);
    // The binding of a time-varying variable holds at all times.
    let varies = !matches!(
        cx.instances[id].prefix.variability,
        Some(Variability::Constant | Variability::Parameter)
    );
    let place = if varies { Place::Always } else { Place::Start };
    let (value, unitless) = cx.with_unitless_literals(|cx| {
        cx.in_place(place, |cx| match constant {
            true => cx.parameter_value(id, span),
            false => cx.binding_value(id),
        })
    });
    if unitless {
        flat.unitless_literals.insert(flat.variables[first].span);
    }
    let Some(value) = value else { return };
    let setting = cx.binding(id).is_some_and(|b| b.setting);
    if value.dims() != &**dims && !(setting && value.dims().is_empty()) {
        let name = flat.variables[first].name.split('[').next().unwrap_or_default();
        let (declared, given) = (dims.to_vec(), value.dims().to_vec());
        let variable = Some(name.to_string());
        cx.report(ArrayCause::BindingSize { variable, declared, given }, span);
        return;
    }
    let none = cx.no_sizes.clone();
    let Some(value) = cx.spread(value, dims, &none, span) else { return };
    if cx.instances[id].prefix.variability == Some(Variability::Parameter) && !cx.from_outside(span)
    {
        let mut scalars = value.elements().iter().filter_map(Value::scalar);
        if scalars.any(|e| cx.variability(e) > Variability::Parameter) {
            cx.report_variability(id, span, Varying::Variable);
            return;
        }
    }
    let own = cx.instances[id].declaration.as_ref().and_then(|d| d.clause().prefix.variability);
    if ty == Type::Real && own == Some(Variability::Discrete) && !cx.from_outside(span) {
        report_bound_discrete(cx, id, span);
        return;
    }
    let is_field =
        cx.instances[id].parent.is_some_and(|parent| super::connect::is_record(cx, parent));
    let value = if is_field { cx.with_own_events(&value) } else { value };
    if !matches!(ty, Type::Real | Type::String) && !cx.from_outside(span) {
        let mut scalars = value.elements().iter().filter_map(Value::scalar);
        if scalars.any(|e| cx.changes_unseen(e)) {
            cx.report_continuous(ty, span);
            return;
        }
    }
    for (k, e) in value.elements().iter().enumerate() {
        let v = VarId(first.0 + k as u32);
        let Some(e) = e.scalar() else { continue };
        flat.variables[v].binding = converted(cx, e, ty, span, "value");
    }
}

/// Reports a `discrete` Real with a binding: its value must come from when-clauses (Modelica 3.6,
/// section 4.4.4).
fn report_bound_discrete(cx: &mut Evaluator<'_>, id: InstanceId, span: Span) {
    let path = cx.path(id);
    let declared = cx.declared_at(id);
    cx.problems.push(
        Diagnostic::new(FlattenCause::BoundDiscrete { path }, span)
            .label("holds at all times")
            .also(declared, "declared `discrete`"),
    );
}

/// Converts an expression to the type: Integer literals become Real literals; incompatible types
/// are reported.
fn converted(
    cx: &mut Evaluator<'_>,
    e: ExprId,
    ty: Type,
    span: Span,
    what: &str,
) -> Option<ExprId> {
    let given = cx.graph.ty(e);
    match (ty, given) {
        (Type::Real, Type::Integer) => match cx.graph.as_const(e) {
            Some(Const::Integer(i)) => Some(cx.graph.real(i as f64)),
            _ => Some(e),
        },
        (s, t) if s == t => Some(e),
        _ => {
            let wanted = crate::symbolic::print::type_name(&cx.graph, ty);
            let given = crate::symbolic::print::type_name(&cx.graph, given);
            let expected = Expected::Attribute { attribute: what.to_string(), ty: wanted };
            cx.report(TypeCause::WrongType { expected, found: given }, span);
            None
        }
    }
}
