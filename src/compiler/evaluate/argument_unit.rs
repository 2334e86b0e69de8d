//! The units of the inputs of functions (section 19.1 of the specification). Arguments of calls in a model are noted
//! together with the unit of the input; `units` compares them when the units of all variables are known.
//!
//! Calls inside of functions are not noted: their arguments are symbols, which have no units.

use std::rc::Rc;

use super::Evaluator;
use super::function::Components;
use super::value::Value;
use crate::base::index::{FastMap, FastSet};
use crate::base::name::{Name, name};
use crate::base::source::Span;
use crate::ir::ast::{ArgumentKind, Causality, Component, ExprKind, Modification};
use crate::ir::expr::Type;
use crate::ir::flat::UnitOfArgument;
use crate::ir::instance::{ClassId, Declaration, Entry};

/// Elements of an argument that are compared: those of an array usually come from one place.
const MOST_ELEMENTS: usize = 8;

/// The arguments whose units are compared later.
#[derive(Default)]
pub(crate) struct ArgumentUnits {
    /// The inputs of each function that was called, with their units; `None` for those that have none.
    of_inputs: FastMap<ClassId, Rc<[Option<(Name, Name)>]>>,
    met: FastSet<UnitOfArgument>,
    /// In the order of the calls.
    pub(crate) noted: Vec<UnitOfArgument>,
}

impl Evaluator<'_> {
    /// Notes the arguments of a call whose inputs have units, one of `given` for each input.
    pub(super) fn note_units_of_arguments(
        &mut self,
        class: ClassId,
        components: &Components,
        given: &[Option<Value>],
        span: Span,
    ) {
        // A constant that was read as a plain number has lost its unit.
        let is_in_model = !self.frames.in_function() && !self.mode.is_before_simulation();
        if !is_in_model || self.units.unitless_literal {
            return;
        }
        let units = self.units_of_inputs(class, components);
        let function = self.classes[class].full_name;
        for (input, value) in units.iter().zip(given) {
            let (Some((input, unit)), Some(value)) = (*input, value) else { continue };
            let mut compared = Vec::new();
            value.for_each_scalar(&mut |e| {
                let is_open = self.graph.ty(e) == Type::Real && self.graph.as_const(e).is_none();
                if is_open && compared.len() < MOST_ELEMENTS {
                    compared.push(e);
                }
            });
            for value in compared {
                let argument = UnitOfArgument { value, unit, function, input, span };
                if self.argument_units.met.insert(argument) {
                    self.argument_units.noted.push(argument);
                }
            }
        }
    }

    fn units_of_inputs(
        &mut self,
        class: ClassId,
        components: &Components,
    ) -> Rc<[Option<(Name, Name)>]> {
        if let Some(known) = self.argument_units.of_inputs.get(&class) {
            return known.clone();
        }
        let mut units = Vec::new();
        for (entry, declaration) in components {
            if self.causality(entry, declaration) == Some(Causality::Input) {
                let unit = self.declared_unit(entry, declaration);
                units.push(unit.map(|unit| (entry.name.name, unit)));
            }
        }
        let units: Rc<[_]> = units.into();
        self.argument_units.of_inputs.insert(class, units.clone());
        units
    }

    /// The unit that a declaration or its type gives to a scalar.
    fn declared_unit(&mut self, entry: &Entry, declaration: &Declaration) -> Option<Name> {
        let outer = entry.layers.iter().find_map(|(m, _)| unit_in_layer(m, entry.name.name));
        let own = || unit_of_component(declaration.component());
        outer.or_else(own).or_else(|| {
            let scope = self.declaration_scope(entry);
            let class = self.find_class(&declaration.clause().type_name, scope)?;
            let table = self.table(class);
            table.scalar?;
            table.layers.iter().find_map(|layer| literal_unit(layer.inner()?))
        })
    }
}

/// The unit that a modification of a class gives to one of its components.
fn unit_in_layer(m: &Modification, component: Name) -> Option<Name> {
    m.args.iter().find_map(|argument| match &argument.kind {
        ArgumentKind::Element { path, modification: Some(inner), .. } => {
            match path.parts.as_slice() {
                [one] if one.name == component => literal_unit(inner),
                _ => None,
            }
        }
        _ => None,
    })
}

fn unit_of_component(component: &Component) -> Option<Name> {
    component.modification.as_deref().and_then(literal_unit)
}

/// The value of `unit` in a modification.
fn literal_unit(m: &Modification) -> Option<Name> {
    m.args.iter().find_map(|argument| match &argument.kind {
        ArgumentKind::Element { path, modification: Some(inner), .. } => {
            let is_unit = matches!(path.parts.as_slice(), [one] if one.name == "unit");
            match &inner.binding.as_ref().filter(|_| is_unit)?.kind {
                ExprKind::String(text) if !text.is_empty() => Some(name(text)),
                _ => None,
            }
        }
        _ => None,
    })
}
