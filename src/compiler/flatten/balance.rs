//! Checks that a component is balanced, i.e. has as many equations as unknowns (Modelica 3.6,
//! section 4.7).
//!
//! The component is flattened on its own. Its inputs are known, and so is one variable of each pair
//! of potential and flow of its connectors: the flows of unconnected connectors are zero, and this
//! equation represents the one that a connection would add.

use super::cause::FlattenCause;
use crate::base::diag::{Diagnostic, Problems};
use crate::base::index::{FastMap, FastSet};
use crate::evaluate::Evaluator;
use crate::ir::ast::{Causality, ClassKind, Variability};
use crate::ir::expr::VarId;
use crate::ir::flat::{Action, EquationKind, FlatModel};
use crate::ir::instance::{InstanceId, InstanceKind};

/// Numbers of scalar unknowns and equations.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct EquationBalance {
    /// Unknowns.
    pub unknowns: usize,
    /// Equations.
    pub equations: usize,
}

impl EquationBalance {
    /// Reports an error if the numbers differ.
    pub fn report(&self, flat: &FlatModel, problems: &mut Problems) {
        let EquationBalance { unknowns, equations } = *self;
        if unknowns == equations {
            return;
        }
        let component = flat.name.to_string();
        problems.push(
            Diagnostic::new(FlattenCause::Unbalanced { component, equations, unknowns }, flat.span)
                .note(
                    "inputs are known from outside, and so is one of each potential and its flow",
                ),
        );
    }
}

/// Counts equations and unknowns; `None` for a component with expandable connectors, whose
/// variables depend on the surroundings, or with overdetermined variables in its connectors: whether
/// these are known from outside depends on the root of the whole model (section 9.4).
pub(super) fn of(
    cx: &mut Evaluator<'_>,
    root: InstanceId,
    flat: &FlatModel,
) -> Option<EquationBalance> {
    if let InstanceKind::Object(children) = cx.instances[root].kind.clone() {
        for child in children.iter() {
            if let Some(class) = cx.instances[*child].class
                && cx.kind(class) == ClassKind::ExpandableConnector
            {
                return None;
            }
            if super::connect::is_connector(cx, *child) && has_overdetermined(cx, *child) {
                return None;
            }
        }
    }
    let mut unknowns = 0;
    let mut bound = 0;
    // Inputs of the component itself, also in its connectors, are known.
    let mut known: FastMap<InstanceId, bool> = FastMap::default();
    for (v, variable) in flat.variables.enumerate() {
        if matches!(variable.variability, Variability::Constant | Variability::Parameter) {
            continue;
        }
        // A delayed expression belongs to no instance and has an equation of its own.
        let from_outside = match cx.instance_of.get(v.0 as usize) {
            None => false,
            Some(&(instance, _)) => match known.get(&instance) {
                Some(known) => *known,
                None => {
                    let input = is_input(cx, instance, root);
                    known.insert(instance, input);
                    input
                }
            },
        };
        if from_outside && variable.binding.is_none() {
            continue;
        }
        unknowns += 1;
        bound += usize::from(variable.binding.is_some());
    }
    let mut equations = bound;
    let mut assigned: FastSet<VarId> = FastSet::default();
    for equation in &flat.equations {
        match &equation.kind {
            EquationKind::Equal(..) => equations += 1,
            EquationKind::Algorithm { outputs, .. } => assigned.extend(outputs),
            EquationKind::When(branches) => {
                for action in branches.iter().flat_map(|b| &b.actions) {
                    if let Action::Assign(v, _) = action {
                        assigned.insert(*v);
                    }
                }
            }
            EquationKind::Assert(_) => {}
        }
    }
    equations += assigned.len();
    Some(EquationBalance { unknowns, equations })
}

/// True for a connector, or an array of connectors, with an overdetermined variable or record.
fn has_overdetermined(cx: &mut Evaluator<'_>, id: InstanceId) -> bool {
    cx.complete(id);
    if cx.is_overdetermined(id) {
        return true;
    }
    match cx.instances[id].kind.clone() {
        InstanceKind::Array { elements, .. } => {
            elements.first().is_some_and(|first| has_overdetermined(cx, *first))
        }
        InstanceKind::Object(children) => {
            children.iter().any(|child| has_overdetermined(cx, *child))
        }
        _ => false,
    }
}

/// True for an input of the component, declared in it or in one of its connectors.
fn is_input(cx: &mut Evaluator<'_>, id: InstanceId, root: InstanceId) -> bool {
    // Protected inputs are determined inside the component.
    if cx.instances[id].prefix.causality != Some(Causality::Input) || cx.instances[id].protected {
        return false;
    }
    let mut at = cx.instances[id].parent;
    while let Some(holder) = at {
        if holder == root {
            return true;
        }
        let array = matches!(cx.instances[holder].kind, InstanceKind::Array { .. });
        if !array
            && !super::connect::is_connector(cx, holder)
            && !super::connect::is_record(cx, holder)
        {
            return false;
        }
        at = cx.instances[holder].parent;
    }
    false
}
