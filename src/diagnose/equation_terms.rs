//! Equations that may lack a term, and the variables that the term may depend on.
//!
//! Where a model has connectors, what it lacks is a flow at one of them. Elsewhere its equations are written out, and what
//! they lack is a term: of every equation in the model's own source that determines the rate of a state, unless it
//! already has the flow of a connector.

use crate::flatten::rate_equation::{RateEquation, rate_equations};
use crate::ir::expr::VarId;
use crate::ir::flat::FlatModel;

use super::catalogue::Effect;
use super::place::Place;

/// Equations that a term may be added to.
const MAX_EQUATIONS: usize = 6;
/// Variables of which products are formed.
const MAX_FACTORS: usize = 6;

/// The equations of a model that may lack a term.
#[derive(Clone, Debug, Default)]
pub struct EquationTerms {
    rates: Vec<Rate>,
    /// Variables that a term may depend on, each with its unit.
    variables: Vec<(String, String)>,
}

/// The rate of a state.
#[derive(Clone, Debug)]
struct Rate {
    /// As in `der(w)`.
    name: String,
    state: String,
    /// Unit of the state.
    unit: String,
}

impl EquationTerms {
    /// Those of a flat model, with the variables that its parameters may vary with.
    pub fn new(flat: &FlatModel, variables: &[String]) -> EquationTerms {
        let is_flow =
            |v: &VarId| flat.ownership.is_flow.get(v.0 as usize).copied().unwrap_or(false);
        let is_own =
            |e: &RateEquation| e.span.file == flat.span.file && !e.reads.iter().any(|v| is_flow(v));
        let rate = |e: RateEquation| {
            let state = &flat.variables[e.state];
            Rate { name: e.name(flat), state: state.name.clone(), unit: state.unit.to_string() }
        };
        let equations = rate_equations(flat).into_iter().filter(is_own);
        let unit = |name: &String| {
            let own = flat.variables.iter().find(|v| v.name == *name);
            own.map(|v| (name.clone(), v.unit.to_string()))
        };
        EquationTerms {
            rates: equations.take(MAX_EQUATIONS).map(rate).collect(),
            variables: variables.iter().filter_map(unit).collect(),
        }
    }

    /// Every equation with every choice of variables for the inputs of an effect that is a term.
    pub fn places(&self, effect: &Effect) -> Vec<Place> {
        let inputs: Vec<&str> = effect.binds.iter().map(|(input, _)| input.as_str()).collect();
        let mut out = Vec::new();
        for rate in &self.rates {
            let place = |names: &[&str]| {
                let binds = inputs.iter().zip(names);
                let binds = binds.map(|(i, v)| ((*i).to_owned(), (*v).to_owned())).collect();
                Place { binds, ..Place::at(std::slice::from_ref(&rate.name)) }
            };
            match inputs.as_slice() {
                [] => out.push(place(&[])),
                [input] if effect.is_of_state => {
                    if self.fits(effect, input, &rate.unit) {
                        out.push(place(&[rate.state.as_str()]));
                    }
                }
                [input] => out.extend(self.fitting(effect, input).map(|v| place(&[v]))),
                [first, second] => {
                    let factors: Vec<&str> =
                        self.fitting(effect, second).take(MAX_FACTORS).collect();
                    for (k, x) in self.fitting(effect, first).take(MAX_FACTORS).enumerate() {
                        out.extend(factors.iter().skip(k + 1).map(|y| place(&[x, *y])));
                    }
                }
                _ => {}
            }
        }
        out
    }

    /// The variables that an input can be bound to.
    fn fitting<'a>(&'a self, effect: &'a Effect, input: &'a str) -> impl Iterator<Item = &'a str> {
        let fitting = self.variables.iter().filter(move |(_, unit)| self.fits(effect, input, unit));
        fitting.map(|(name, _)| name.as_str())
    }

    /// Whether an input can be bound to a variable of a unit: to one of its own unit, or to any if it has none or if the
    /// model declares no units.
    fn fits(&self, effect: &Effect, input: &str, unit: &str) -> bool {
        let own = effect.units.iter().find(|(name, _)| name == input);
        let own = own.map_or("", |(_, unit)| unit.as_str());
        let has_units = self.variables.iter().any(|(_, unit)| !unit.is_empty());
        own.is_empty() || own == unit || !has_units
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn effect(inputs: &[&str], unit: &str) -> Effect {
        Effect {
            adds: Some("term".into()),
            binds: inputs.iter().map(|i| ((*i).to_owned(), Vec::new())).collect(),
            units: inputs.iter().map(|i| ((*i).to_owned(), unit.to_owned())).collect(),
            ..Effect::default()
        }
    }

    #[test]
    fn inputs_are_bound_to_variables_of_their_units() {
        let pair = |a: &str, b: &str| (a.to_owned(), b.to_owned());
        let mut terms = EquationTerms {
            rates: vec![Rate { name: "der(w)".into(), state: "w".into(), unit: "rad/s".into() }],
            variables: vec![pair("phi", "rad"), pair("w", "rad/s"), pair("T", "K")],
        };
        let bound = |terms: &EquationTerms, effect: &Effect| -> Vec<Vec<String>> {
            let variables = |p: &Place| p.binds.iter().map(|(_, v)| v.clone()).collect();
            terms.places(effect).iter().map(variables).collect()
        };
        assert_eq!(bound(&terms, &effect(&[], "")), [Vec::<String>::new()]);
        assert_eq!(bound(&terms, &effect(&["x"], "rad")), [["phi"]]);
        assert_eq!(bound(&terms, &effect(&["x"], "")).len(), 3);
        let pairs = [["phi", "w"], ["phi", "T"], ["w", "T"]];
        assert_eq!(bound(&terms, &effect(&["x", "y"], "")), pairs);
        let of_state = |unit: &str| Effect { is_of_state: true, ..effect(&["x"], unit) };
        assert_eq!(bound(&terms, &of_state("")), [["w"]]);
        assert!(bound(&terms, &of_state("K")).is_empty());
        terms.variables.iter_mut().for_each(|(_, unit)| unit.clear());
        assert_eq!(bound(&terms, &of_state("K")), [["w"]]);
        assert_eq!(bound(&terms, &effect(&["x"], "rad")).len(), 3);
    }
}
