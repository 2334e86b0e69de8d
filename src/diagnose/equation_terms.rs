//! Equations that may lack a term, and the variables that the term may depend on.
//!
//! Where a model has connectors, what it lacks is a flow at one of them. Elsewhere its equations are written out, and what
//! they lack is a term: of every equation in the model's own source that determines the rate of a state or, in a model
//! without states, is solved for a measured variable, unless it already has the flow of a connector. Beside states, the
//! equation of a measured variable is among them if it is a law as well: if it reads parameters and several variables.
//! So is that of a variable which several rates read, such as the torque between two bodies.
//!
//! A term may also depend on a [difference](super::difference) of two variables, as an exchange between bodies does.

use crate::base::index::FastSet;
use crate::calibrate::plan::Plan;
use crate::flatten::open_equation::{Determined, OpenEquation, explicit_equation, rate_equations};
use crate::ir::expr::VarId;
use crate::ir::flat::FlatModel;
use crate::units::dimension::Dimension;
use crate::units::unit::Unit;

use super::catalogue::Effect;
use super::difference::as_difference;
use super::place::Place;
use super::variation::VariationTargets;

/// Equations that a term may be added to.
const MAX_EQUATIONS: usize = 6;
/// Terms of an equation that may act otherwise.
const MAX_TERMS: usize = 4;
/// Variables of which products are formed.
const MAX_FACTORS: usize = 6;
/// Variables that the equation of a measured variable beside states reads at least.
const LEAST_READ: usize = 2;

/// The equations of a model that may lack a term.
#[derive(Clone, Debug, Default)]
pub struct EquationTerms {
    equations: Vec<Equation>,
    /// Variables that a term may depend on.
    variables: Vec<String>,
    /// Differences of two variables, which it may depend on as well.
    differences: Vec<String>,
    /// Variables and differences with a unit that is not one of a speed.
    no_speeds: FastSet<String>,
}

/// An equation that may lack a term.
#[derive(Clone, Debug)]
struct Equation {
    /// What it determines: `der(w)` or `F`.
    name: String,
    /// The state whose rate it determines.
    state: Option<String>,
    /// The terms that it has, with their signs.
    terms: Vec<String>,
}

impl EquationTerms {
    /// Those of a flat model and a plan, with the variables that parameters may vary with.
    pub fn new(flat: &FlatModel, plan: &Plan, variations: &VariationTargets) -> EquationTerms {
        let is_flow =
            |v: &VarId| flat.ownership.is_flow.get(v.0 as usize).copied().unwrap_or(false);
        let is_own =
            |e: &OpenEquation| e.span.file == flat.span.file && !e.reads.iter().any(is_flow);
        let named = |name: &str| flat.variables.enumerate().find(|(_, x)| x.name == name);
        // The equations around an FMU only pass its signals on.
        if plan.fmu.is_some() {
            return EquationTerms::default();
        }
        let mut all: Vec<OpenEquation> = rate_equations(flat);
        // Beside states, the equation of a measured variable may only say how it is measured: a scale, or a difference.
        let has_rates = !all.is_empty();
        for signal in &plan.signals {
            let explicit = named(&signal.variable).and_then(|(v, _)| explicit_equation(flat, v));
            let is_open = |e: &OpenEquation| {
                let is_law = !has_rates || e.has_parameter && e.reads.len() >= LEAST_READ;
                is_law && !all.iter().any(|known| known.is_same(e))
            };
            let explicit = explicit.filter(is_open);
            all.extend(explicit);
        }
        // What several rates read may lack a term that a single one of them cannot have: what one body gains, another loses.
        let shared = shared_variables(&all);
        let laws = shared.into_iter().filter_map(|v| explicit_equation(flat, v));
        let is_open = |e: &OpenEquation| {
            e.has_parameter && !e.has_rate && !all.iter().any(|known| known.is_same(e))
        };
        let laws: Vec<OpenEquation> = laws.filter(is_open).collect();
        all.extend(laws);
        let equation = |e: OpenEquation| {
            let state = match e.determines {
                Determined::Rate(state) => Some(&flat.variables[state]),
                Determined::Variable(_) => None,
            };
            let mut terms = e.terms(flat);
            terms.truncate(MAX_TERMS);
            Equation { name: e.name(flat), state: state.map(|x| x.name.clone()), terms }
        };
        let (variables, differences) = (&variations.variables, variations.differences.clone());
        let of_first =
            |d: &String| as_difference(d).and_then(|(a, _)| named(a)).map(|(_, x)| (d.clone(), x));
        let all_named = flat.variables.iter().map(|x| (x.name.clone(), x));
        let no_speeds = all_named
            .chain(differences.iter().filter_map(of_first))
            .filter(|(_, x)| !may_be_speed(&x.unit))
            .map(|(name, _)| name)
            .collect();
        EquationTerms {
            equations: all.into_iter().filter(is_own).take(MAX_EQUATIONS).map(equation).collect(),
            variables: variables.iter().filter(|v| *v != "time").cloned().collect(),
            differences,
            no_speeds,
        }
    }

    /// Every equation with every choice of variables for the inputs of an effect that is a term.
    pub fn places(&self, effect: &Effect) -> Vec<Place> {
        let inputs: Vec<&str> = effect.binds.iter().map(|(input, _)| input.as_str()).collect();
        let mut out = Vec::new();
        for equation in &self.equations {
            let place = |names: &[&str]| {
                let binds = inputs.iter().zip(names);
                let binds = binds.map(|(i, v)| ((*i).to_owned(), (*v).to_owned())).collect();
                // How late another term acts is positive everywhere.
                let is_signed = equation.state.is_none() && !effect.is_of_term;
                Place { binds, is_signed, ..Place::at(std::slice::from_ref(&equation.name)) }
            };
            let fits = |v: &&str| !effect.is_of_speed || !self.no_speeds.contains(*v);
            match inputs.as_slice() {
                [] => out.push(place(&[])),
                [_] if effect.is_of_term => {
                    out.extend(equation.terms.iter().map(|term| place(&[term.as_str()])));
                }
                [_] => match equation.state.as_ref().filter(|_| effect.is_of_state) {
                    Some(state) => {
                        let own = Some(state.as_str()).filter(fits);
                        out.extend(own.map(|state| place(&[state])));
                    }
                    None => {
                        let differences = self.differences.iter().map(String::as_str);
                        let all = self.others(&equation.name).chain(differences);
                        out.extend(all.filter(fits).map(|v| place(&[v])));
                    }
                },
                [_, _] => {
                    let factors: Vec<&str> =
                        self.others(&equation.name).take(MAX_FACTORS).collect();
                    for (k, x) in factors.iter().enumerate() {
                        out.extend(factors[k + 1..].iter().map(|y| place(&[x, *y])));
                        if effect.is_ordered {
                            out.extend(factors[k + 1..].iter().map(|y| place(&[*y, x])));
                        }
                    }
                }
                _ => {}
            }
        }
        out
    }

    /// The variables that a term may depend on, without the one that the equation is solved for.
    fn others<'a>(&'a self, solved_for: &'a str) -> impl Iterator<Item = &'a str> {
        self.variables.iter().map(String::as_str).filter(move |name| *name != solved_for)
    }
}

/// The variables that at least two of the equations of rates read, in order.
fn shared_variables(equations: &[OpenEquation]) -> Vec<VarId> {
    let of_rates = equations.iter().filter(|e| matches!(e.determines, Determined::Rate(_)));
    let mut read: Vec<VarId> = of_rates.flat_map(|e| e.reads.iter().copied()).collect();
    read.sort_unstable();
    let mut shared: Vec<VarId> = read.windows(2).filter(|w| w[0] == w[1]).map(|w| w[0]).collect();
    shared.dedup();
    shared
}

/// True for the unit of a speed, and for none.
fn may_be_speed(unit: &str) -> bool {
    let linear = Dimension::new([0, 1, -1, 0, 0, 0, 0]);
    let angular = Dimension::ONE.over(Dimension::TIME);
    let is_undeclared = ["", "1"].contains(&unit);
    is_undeclared || Unit::of(unit).is_none_or(|u| [linear, angular].contains(&u.dimension))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_speed_has_its_unit_or_none() {
        let all = ["m/s", "rad/s", "rev/min", "mm/s", "km/h", "", "1"];
        assert!(all.into_iter().all(may_be_speed));
        assert!(!["kg", "K", "mol/m3", "A", "m", "rad", "m3/s"].into_iter().any(may_be_speed));
    }

    fn effect(inputs: &[&str]) -> Effect {
        Effect {
            adds: Some("term".into()),
            binds: inputs.iter().map(|i| ((*i).to_owned(), Vec::new())).collect(),
            ..Effect::default()
        }
    }

    #[test]
    fn inputs_are_bound_to_each_choice_of_variables() {
        let equation = |name: &str, state: Option<&str>| Equation {
            name: name.to_owned(),
            state: state.map(str::to_owned),
            terms: vec!["-c*w".to_owned()],
        };
        let bound = |equation: Equation, effect: &Effect| -> Vec<Vec<String>> {
            let terms = EquationTerms {
                equations: vec![equation],
                variables: ["phi", "w", "F"].map(String::from).to_vec(),
                differences: vec!["w - w_2".to_owned()],
                no_speeds: FastSet::from_iter(["F".to_owned()]),
            };
            let variables = |p: &Place| p.binds.iter().map(|(_, v)| v.clone()).collect();
            terms.places(effect).iter().map(variables).collect()
        };
        let rate = || equation("der(w)", Some("w"));
        let force = || equation("F", None);
        assert_eq!(bound(rate(), &effect(&[])), [Vec::<String>::new()]);
        assert_eq!(bound(rate(), &effect(&["x"])), [["phi"], ["w"], ["F"], ["w - w_2"]]);
        assert_eq!(bound(force(), &effect(&["x"])), [["phi"], ["w"], ["w - w_2"]]);
        assert_eq!(bound(force(), &effect(&["x", "y"])), [["phi", "w"]]);
        let ordered = Effect { is_ordered: true, ..effect(&["x", "y"]) };
        assert_eq!(bound(force(), &ordered), [["phi", "w"], ["w", "phi"]]);
        let of_state = Effect { is_of_state: true, ..effect(&["x"]) };
        assert_eq!(bound(rate(), &of_state), [["w"]]);
        assert_eq!(bound(force(), &of_state), [["phi"], ["w"], ["w - w_2"]]);
        let of_speed = Effect { is_of_speed: true, ..of_state };
        assert_eq!(bound(rate(), &of_speed), [["w"]]);
        assert_eq!(bound(equation("der(F)", Some("F")), &of_speed), Vec::<Vec<String>>::new());
        let of_term = Effect { is_of_term: true, ..effect(&["x"]) };
        assert_eq!(bound(rate(), &of_term), [["-c*w"]]);
    }
}
