//! Parameters whose values the plan takes for granted. One of them may be wrong: a dimension of the data sheet, a stiffness
//! that was measured once. So may the start of a state.

use crate::base::index::{FastMap, FastSet};
use crate::calibrate::plan::Plan;
use crate::flatten::start_offset::starts_by_declaration;
use crate::ir::expr::{ExprId, Node, Type, VarId};
use crate::ir::flat::{FlatModel, Variability, Variable};

use super::hypothesis::{ChosenEffect, Hypothesis};
use super::place::Place;
use super::study::Study;
use super::variation::states;

/// Largest number of such parameters that are looked at.
const MAX_PARAMETERS: usize = 400;

/// A parameter and the value that the model gives it.
#[derive(Clone, Debug, PartialEq)]
pub struct FixedValue {
    /// Its full name.
    pub parameter: String,
    /// Its value, not zero.
    pub value: f64,
}

/// The Real parameters of a model whose values are numbers, which neither the plan nor a recording determines, and on
/// which equations depend while the structure does not; and where components share such a parameter, that of each. None
/// of an FMU: each would take runs of its own.
pub fn fixed_values(flat: &FlatModel, plan: &Plan) -> Vec<FixedValue> {
    if plan.fmu.is_some() {
        return Vec::new();
    }
    let determined: FastSet<&str> = determined(plan).collect();
    let (read, structural) = (read(flat), structural(flat));
    let fits = |v: VarId, x: &Variable| {
        x.ty == Type::Real
            && x.variability == Variability::Parameter
            && read.contains(&v)
            && !structural.contains(&v)
            && !determined.contains(x.name.as_str())
    };
    let mut known: FastMap<VarId, f64> = FastMap::default();
    let mut sharing: FastMap<VarId, usize> = FastMap::default();
    let (mut own, mut shared) = (Vec::new(), Vec::new());
    for (v, x) in flat.variables.enumerate().filter(|(v, x)| fits(*v, x)) {
        let Some(binding) = x.binding else { continue };
        if let Some(value) = literal(flat, binding).filter(|x| *x != 0.0 && x.is_finite()) {
            known.insert(v, value);
            own.push(FixedValue { parameter: x.name.clone(), value });
        } else if let Node::Var(source) = flat.graph.node(binding) {
            shared.push((source, x));
            *sharing.entry(source).or_default() += 1;
        }
    }
    let of_components = shared.into_iter().filter(|(source, _)| sharing[source] > 1);
    own.extend(of_components.filter_map(|(source, x)| {
        Some(FixedValue { parameter: x.name.clone(), value: *known.get(&source)? })
    }));
    own.truncate(MAX_PARAMETERS);
    own
}

/// The states whose declarations fix their starts, unless the plan fits these.
pub fn fixed_starts(flat: &FlatModel, plan: &Plan) -> Vec<String> {
    let determined: FastSet<&str> = determined(plan).collect();
    let is_fitted = |name: &str| determined.contains(format!("start({name})").as_str());
    let fixed = states(flat).into_iter().map(|v| &flat.variables[v]);
    let fixed = fixed.filter(|x| starts_by_declaration(x) && !is_fitted(&x.name));
    fixed.map(|x| x.name.clone()).collect()
}

/// A place at each of them.
pub fn places(values: &[FixedValue]) -> Vec<Place> {
    values.iter().map(|v| Place::at(std::slice::from_ref(&v.parameter))).collect()
}

/// A parameter whose value in the model is wrong.
#[derive(Clone, Debug, PartialEq)]
pub struct CorrectedValue {
    /// Its full name.
    pub parameter: String,
    /// Its value in the model.
    pub in_model: f64,
    /// The value that the recordings support.
    pub value: f64,
    /// The standard error of that.
    pub error: f64,
}

/// The value that an effect of this kind gives its parameter: that of the model times `exp(a)`. `None` for another effect.
pub fn corrected_value(
    study: &Study,
    hypothesis: &Hypothesis,
    chosen: &ChosenEffect,
) -> Option<CorrectedValue> {
    let effect = Some(&study.effects[chosen.effect]).filter(|e| e.is_other_value())?;
    let parameter = chosen.place.at.first()?.clone();
    let in_model = study.fixed_values.iter().find(|v| v.parameter == parameter)?.value;
    let (a, error) = hypothesis.estimate(&chosen.full_name(&effect.amplitudes.first()?.name))?;
    let value = in_model * a.exp();
    Some(CorrectedValue { parameter, in_model, value, error: (value * error).abs() })
}

/// The names that a plan gives values to.
fn determined(plan: &Plan) -> impl Iterator<Item = &str> {
    let free = plan.free.iter().flat_map(|f| f.targets.iter().map(String::as_str));
    let conditions = plan.conditions.iter().map(|c| c.parameter.as_str());
    free.chain(conditions)
}

/// The value of a number.
fn literal(flat: &FlatModel, e: ExprId) -> Option<f64> {
    flat.graph.as_const(e)?.number()
}

/// Adds the parameters from which those of a set are computed.
fn with_sources(flat: &FlatModel, set: &mut FastSet<VarId>) {
    let mut pending: Vec<VarId> = set.iter().copied().collect();
    while let Some(v) = pending.pop() {
        let x = &flat.variables[v];
        let binding = x.binding.filter(|_| x.variability <= Variability::Parameter);
        for source in binding.into_iter().flat_map(|e| flat.graph.variables(e)) {
            if set.insert(source) {
                pending.push(source);
            }
        }
    }
}

/// The variables that equations read, directly or by way of parameters.
fn read(flat: &FlatModel) -> FastSet<VarId> {
    let mut found = FastSet::default();
    let mut roots = Vec::new();
    for e in flat.equations.iter() {
        e.for_each_expression(&mut |e| roots.push(e));
    }
    let continuous = flat.variables.iter().filter(|x| x.variability > Variability::Parameter);
    roots.extend(continuous.filter_map(|x| x.binding));
    for e in flat.graph.postorder(roots) {
        if let Node::Var(v) = flat.graph.node(e) {
            found.insert(v);
        }
    }
    with_sources(flat, &mut found);
    found
}

/// The parameters that determine the structure, directly or by way of others.
fn structural(flat: &FlatModel) -> FastSet<VarId> {
    let own = flat.variables.enumerate().filter(|(_, x)| x.structural).map(|(v, _)| v);
    let mut found = own.collect();
    with_sources(flat, &mut found);
    found
}
