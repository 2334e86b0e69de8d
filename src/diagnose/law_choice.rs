//! Laws that the model itself offers: every other literal of an enumeration parameter that selects a law, and
//! the laws that a class of the model describes in its annotation.
//!
//! A law is chosen before the run, so no derivative leads from one to another. It is scored by what the
//! linearised model with the other law would leave, and its own parameters, those that only the new law
//! reads, start from the best point of a grid around the model's values.

use crate::base::index::FastSet;
use crate::driver::compile::{Request, Session};
use crate::ir::expr::{Node, Type, VarId};
use crate::ir::flat::{FlatModel, Variability};

use super::catalogue::{Effect, Start};

/// Factors by which the start of a law's own parameter differs from the model's value.
const STARTS: [f64; 3] = [0.2, 1.0, 5.0];
/// Factor by which a fit may change a law's own parameter.
const REACH: f64 = 1e4;

/// How a law is chosen.
#[derive(Clone, Debug, Default)]
pub struct Choice {
    /// For a law that a parameter of the model selects: the components that use it. Empty for a law that is
    /// built into a component.
    pub at: Vec<String>,
}

impl Choice {
    /// The range in which a parameter of the law is searched.
    pub fn range(start: f64) -> (f64, f64) {
        (start / REACH, start * REACH)
    }

    /// True if a parameter of the model itself selects the law.
    pub fn is_of_model(&self) -> bool {
        !self.at.is_empty()
    }
}

/// The laws that the enumeration parameters of a model offer besides those that it uses.
pub fn choices(request: &Request, flat: &FlatModel) -> Vec<Effect> {
    let mut out = Vec::new();
    for v in flat.variables.iter() {
        let Type::Enumeration(id) = v.ty else { continue };
        // Only a parameter of the model itself: those of components follow from it or are set by it.
        if v.variability != Variability::Parameter || !v.structural || v.name.contains(['.', '[']) {
            continue;
        }
        let kind = &flat.graph.enumerations[id];
        for literal in &kind.literals {
            let value = format!("{}.{literal}", kind.name);
            out.extend(choice(request, flat, &v.name, value));
        }
    }
    out
}

/// The law that a parameter selects by a value; `None` if the model has it, or does not compile with it.
fn choice(request: &Request, flat: &FlatModel, parameter: &str, value: String) -> Option<Effect> {
    let mut request = request.clone();
    request.settings.push(format!("{parameter}={value}"));
    let other = Session::default().flatten(&request).ok()?;
    let (before, after) = (names(flat), names(&other));
    let components: FastSet<&str> = before
        .symmetric_difference(&after)
        .filter_map(|name| name.split_once('.').map(|(component, _)| component))
        .map(|component| component.split('[').next().unwrap_or(component))
        .collect();
    if components.is_empty() {
        return None;
    }
    let mut at: Vec<String> = Vec::new();
    for v in other.variables.iter() {
        let component = v.name.split(['.', '[']).next().unwrap_or_default();
        if components.contains(component) && !at.iter().any(|known| known == component) {
            at.push(component.to_owned());
        }
    }
    let known: FastSet<String> = roots(flat).into_iter().map(|(name, _)| name).collect();
    let own = roots(&other).into_iter().filter(|(name, value)| {
        // A parameter of the law; not a value that its components bring along.
        !known.contains(name) && !name.contains(['.', '[']) && *value > 0.0
    });
    let starts = |value: f64| STARTS.iter().map(|f| Start::Value(f * value)).collect();
    Some(Effect {
        class: value.clone(),
        shape_parameters: own.map(|(n, v)| (n, starts(v))).collect(),
        explains: format!("{value} describes %at better."),
        with: vec![(parameter.to_owned(), value)],
        units: other.variables.iter().map(|v| (v.name.clone(), v.unit.to_string())).collect(),
        built_in: true,
        choice: Some(Choice { at }),
        ..Effect::default()
    })
}

fn names(flat: &FlatModel) -> FastSet<&str> {
    flat.variables.iter().map(|v| v.name.as_str()).collect()
}

/// The parameters with a number as their value on which the equations depend, directly or by way of others.
fn roots(flat: &FlatModel) -> Vec<(String, f64)> {
    let mut pending = Vec::new();
    for e in flat.equations.iter().chain(&flat.initial_equations) {
        e.for_each_expression(&mut |e| pending.push(e));
    }
    for v in flat.variables.iter().filter(|v| v.variability > Variability::Parameter) {
        pending.extend(v.binding.into_iter().chain(v.start));
    }
    let mut seen: FastSet<VarId> = FastSet::default();
    let mut out = Vec::new();
    while !pending.is_empty() {
        let read = flat.graph.postorder(std::mem::take(&mut pending));
        for e in read {
            let Node::Var(v) = flat.graph.node(e) else { continue };
            let x = &flat.variables[v];
            if x.variability != Variability::Parameter || !seen.insert(v) {
                continue;
            }
            let value = x.binding.and_then(|b| flat.graph.as_number(b));
            match value.filter(|_| x.ty == Type::Real && !x.structural) {
                Some(value) => out.push((x.name.clone(), value)),
                None => pending.extend(x.binding),
            }
        }
    }
    out
}
