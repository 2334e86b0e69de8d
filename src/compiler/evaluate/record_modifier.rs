//! Modifications of records in functions and constructors: the values that they give to fields, at any depth (sections 7.2
//! and 12.6 of the specification).

use std::sync::Arc;

use super::Evaluator;
use super::value::Value;
use crate::base::name::Name;
use crate::base::source::Span;
use crate::classes::unsupported::Construct;
use crate::ir::ast::{Argument, ArgumentKind, ClassKind, Expr, Ident, Modification};
use crate::ir::instance::{ClassId, Declaration, Entry, Scope};

/// What modifications give a component.
#[derive(Clone, Default)]
pub(super) struct Given {
    value: Option<GivenValue>,
    fields: Vec<(Name, Given)>,
}

/// A value that a modification gives.
#[derive(Clone)]
struct GivenValue {
    value: Value,
    /// It is that of each element of the arrays around it.
    each: bool,
    span: Span,
}

impl Given {
    /// Nothing.
    pub(super) fn is_nothing(&self) -> bool {
        self.value.is_none() && self.fields.is_empty()
    }

    /// What is given to a field.
    pub(super) fn field(&self, name: Name) -> Option<&Given> {
        self.fields.iter().find(|(n, _)| *n == name).map(|(_, given)| given)
    }

    fn field_mut(&mut self, name: Name) -> &mut Given {
        let at = match self.fields.iter().position(|(n, _)| *n == name) {
            Some(at) => at,
            None => {
                self.fields.push((name, Given::default()));
                self.fields.len() - 1
            }
        };
        &mut self.fields[at].1
    }

    /// Adds what an inner modification gives, which gives way to what is there.
    fn add(&mut self, inner: Given) {
        if self.value.is_none() {
            self.value = inner.value;
        }
        for (name, given) in inner.fields {
            self.field_mut(name).add(given);
        }
    }
}

impl Evaluator<'_> {
    /// What the modifications of a record give to its fields: those of its declaration, of classes that extend the one that
    /// holds it, and those from `outside`, which win. A value of the record as a whole is not evaluated.
    pub(super) fn given_to(
        &mut self,
        entry: &Entry,
        declaration: &Declaration,
        outside: &Given,
    ) -> Option<Given> {
        let mut given = Given { value: None, fields: outside.fields.clone() };
        for (modification, class) in entry.layers.iter() {
            let scope = Scope { instance: self.classes[*class].holder, class: *class };
            for argument in &modification.args {
                if let Some((path, inner)) = element(argument)
                    && let [only] = path
                    && only.name == entry.name.name
                    && inner.binding.is_none()
                {
                    let inner = self.given_by(inner, false, scope)?;
                    given.add(inner);
                }
            }
        }
        if let Some(modification) = &declaration.component().modification
            && modification.binding.is_none()
        {
            given.add(self.given_by(modification, false, self.declaration_scope(entry))?);
        }
        Some(given)
    }

    /// What a modification gives.
    fn given_by(&mut self, modification: &Modification, each: bool, scope: Scope) -> Option<Given> {
        let mut given = Given::default();
        if let Some(binding) = &modification.binding {
            let (value, span) = (self.evaluate_declared(binding, scope)?, binding.span);
            given.value = Some(GivenValue { value, each, span });
            return Some(given);
        }
        for argument in &modification.args {
            if let ArgumentKind::Redeclare(_) = argument.kind {
                self.unsupported(argument.span, Construct::RedeclaredField);
                return None;
            }
            let Some((path, inner)) = element(argument) else { continue };
            let inner = self.given_by(inner, each || argument.each, scope)?;
            let mut at = &mut given;
            for name in path {
                at = at.field_mut(name.name);
            }
            at.add(inner);
        }
        Some(given)
    }

    /// What is given to one element of an array of records with these sizes.
    pub(super) fn given_to_element(
        &mut self,
        given: &Given,
        dims: &[usize],
        at: usize,
    ) -> Option<Given> {
        let mut own = given.clone();
        if let Some(GivenValue { value, each: false, span }) = &mut own.value {
            let is_for_each = value.dims().get(..dims.len()) == Some(dims);
            if !is_for_each {
                let (values, elements) = (value.elements().len(), dims.iter().product());
                self.report_count(values, elements, *span);
                return None;
            }
            *value = value.parts(dims.len()).get(at)?.clone();
        }
        for (_, field) in &mut own.fields {
            *field = self.given_to_element(field, dims, at)?;
        }
        Some(own)
    }

    /// The first value of a field to which modifications give something.
    pub(super) fn modified_start(
        &mut self,
        entry: &Entry,
        declaration: &Declaration,
        given: &Given,
    ) -> Option<Value> {
        let Some(GivenValue { value, each, span }) = given.value.clone() else {
            return match self.declared_value(entry, declaration) {
                // Its fields belong to that value.
                Some(_) => self.local_start(entry, declaration),
                None => self.declared_zero_with(entry, declaration, given),
            };
        };
        if !each {
            return Some(value);
        }
        let sizes = self.declared_sizes(entry, declaration)?;
        match sizes.into_iter().collect::<Option<Vec<usize>>>() {
            Some(dims) => self.spread(value, &dims, &std::rc::Rc::from([]), span),
            None => Some(value),
        }
    }

    /// Whether modifications of a component of this class are values of fields, rather than attributes.
    pub(super) fn has_fields(&mut self, class: ClassId) -> bool {
        self.table(class).scalar.is_none()
            && matches!(self.kind(class), ClassKind::Record | ClassKind::OperatorRecord)
    }
}

/// The path and the modification of an argument that modifies an element.
fn element(argument: &Argument) -> Option<(&[Ident], &Modification)> {
    match &argument.kind {
        ArgumentKind::Element { path, modification: Some(inner), .. } => Some((&path.parts, inner)),
        _ => None,
    }
}

/// All values that a modification gives, at any depth.
pub(super) fn bindings(modification: &Modification) -> Vec<&Arc<Expr>> {
    let mut all = Vec::new();
    for argument in &modification.args {
        if let Some((_, inner)) = element(argument) {
            all.extend(&inner.binding);
            all.extend(bindings(inner));
        }
    }
    all
}
