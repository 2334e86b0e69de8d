//! Laws that the model itself offers: every other literal of an enumeration parameter that selects a law, every other
//! class for a replaceable element, and the laws that a class of the model describes in its annotation.
//!
//! A law is chosen before the run, so no derivative leads from one to another. It is scored by what the
//! linearised model with the other law would leave, and its own parameters, those that only the new law
//! reads, start from the best point of a grid around the model's values.

use crate::base::diag::Problems;
use crate::base::index::FastSet;
use crate::calibrate::parameter::Parameter;
use crate::calibrate::plan::Free;
use crate::calibrate::problem::Problem;
use crate::driver::compile::{Request, Session};
use crate::driver::replacements::Replacement;
use crate::ir::expr::{Const, Node, Type, VarId};
use crate::ir::flat::{FlatModel, Variability};
use crate::numeric::least_squares::Residuals;

use super::catalogue::{Effect, Start};
use super::hypothesis::{ChosenEffect, Hypothesis, attach, attached};
use super::model_source::{Attached, Extension};
use super::place::Place;
use super::rank::Scored;
use super::search::Search;
use super::shape_parameters::shapes;

/// Factors by which the start of a law's own parameter differs from the model's value.
const STARTS: [f64; 3] = [0.2, 1.0, 5.0];
/// The same where the law has more than [`FEW_PARAMETERS`].
const FEWER_STARTS: [f64; 2] = [0.5, 2.0];
const FEW_PARAMETERS: usize = 3;
/// Parameters of its own with which a law is tried.
const MAX_PARAMETERS: usize = 5;
/// Name of the generated model that chooses a law.
const CHOOSING_MODEL: &str = "Choosing";
/// Factor by which a fit may change a law's own parameter.
const REACH: f64 = 1e4;

/// Starts of a law's own parameters from which its model is linearised.
const LINEARISED_STARTS: usize = 2;
/// Damping of the step whose decrease a law promises.
const DAMPING: f64 = 1e-2;

/// How a law is chosen.
#[derive(Clone, Debug, Default)]
pub struct Choice {
    /// For a law that a parameter of the model selects: the components that use it. Empty for a law that is
    /// built into a component.
    pub at: Vec<String>,
    /// For a law that takes the place of a replaceable element: the redeclaration.
    pub replacement: Option<Replacement>,
    /// Parameters that the model no longer has with it.
    pub removed: Vec<String>,
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

/// The laws that the enumeration parameters and the replaceable elements of a model offer besides those that it uses.
pub fn choices(request: &Request, flat: &FlatModel) -> Vec<Effect> {
    let mut out = Vec::new();
    for v in flat.variables.iter() {
        let Type::Enumeration(id) = v.ty else { continue };
        // Only a parameter of the model itself: those of components follow from it or are set by it.
        if v.variability != Variability::Parameter || !v.structural || v.name.contains(['.', '[']) {
            continue;
        }
        let kind = &flat.graph.enumerations[id];
        let own = v.binding.and_then(|b| flat.graph.as_const(b));
        for (number, literal) in (1..).zip(&kind.literals) {
            if own != Some(Const::Enumeration(id, number)) {
                let value = format!("{}.{literal}", kind.name);
                let effect = Effect {
                    class: value.clone(),
                    with: vec![(v.name.clone(), value)],
                    choice: Some(Choice::default()),
                    ..Effect::default()
                };
                out.extend(choice(request, flat, (effect, &v.name)));
            }
        }
    }
    for replacement in Session::default().replacements(request) {
        let element = replacement.element.clone();
        let effect = Effect {
            class: replacement.class.clone(),
            choice: Some(Choice { replacement: Some(replacement), ..Choice::default() }),
            ..Effect::default()
        };
        out.extend(choice(request, flat, (effect, &element)));
    }
    out
}

/// Completes the choice of a law by a parameter or an element of the model; `None` if the model does not compile with it.
fn choice(request: &Request, flat: &FlatModel, (effect, chosen): (Effect, &str)) -> Option<Effect> {
    let mut request = request.clone();
    let effect = Effect { built_in: true, ..effect };
    let place = Place::at(&[chosen.to_owned()]);
    let attached = Attached::new(&effect, &place, String::new(), Vec::new());
    let choosing = Extension { name: CHOOSING_MODEL, base: &flat.name, ..Extension::default() };
    request.appended = Some(choosing.source(&[attached]));
    request.model = Some(CHOOSING_MODEL.to_owned());
    let other = Session::default().flatten(&request).ok()?;
    let (before, after) = (names(flat), names(&other));
    let components: FastSet<&str> = before
        .symmetric_difference(&after)
        .filter_map(|name| name.split_once('.').map(|(component, _)| component))
        .map(|component| component.split('[').next().unwrap_or(component))
        .collect();
    let mut at: Vec<String> = Vec::new();
    for v in other.variables.iter() {
        let component = v.name.split(['.', '[']).next().unwrap_or_default();
        if components.contains(component) && !at.iter().any(|known| known == component) {
            at.push(component.to_owned());
        }
    }
    // Where the law has no components of its own, what chooses it stands for it.
    if at.is_empty() {
        at.push(chosen.to_owned());
    }
    let removed = before.difference(&after).map(|name| (*name).to_owned()).collect();
    let replacement = effect.choice.as_ref().and_then(|c| c.replacement.clone());
    let known: FastSet<String> = roots(flat).into_iter().map(|(name, _)| name).collect();
    // A parameter of the law; of a law that a parameter chooses, not a value that its components bring along.
    let is_own = |(name, value): &(String, f64)| {
        let is_inner = name.contains('.') && replacement.is_none();
        !known.contains(name) && !is_inner && !name.contains('[') && *value > 0.0
    };
    let own: Vec<(String, f64)> =
        roots(&other).into_iter().filter(is_own).take(MAX_PARAMETERS).collect();
    let factors = if own.len() > FEW_PARAMETERS { &FEWER_STARTS[..] } else { &STARTS[..] };
    let starts = |value: f64| factors.iter().map(|f| Start::Value(f * value)).collect();
    Some(Effect {
        shape_parameters: own.into_iter().map(|(n, v)| (n, starts(v))).collect(),
        explains: format!("{} describes %at better.", effect.class),
        units: other.variables.iter().map(|v| (v.name.clone(), v.unit.to_string())).collect(),
        choice: Some(Choice { at, replacement, removed }),
        ..effect
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

/// Scores the laws that the model offers, each with the best start of its own parameters.
pub fn scored_choices(search: &Search<'_>, hypothesis: &Hypothesis) -> Vec<Scored> {
    let study = search.study;
    let is_taken = |place: &Place| {
        let known = |c: &ChosenEffect| study.effects[c.effect].built_in && c.place.at == place.at;
        hypothesis.effects.iter().any(known)
    };
    let mut chosen = Vec::new();
    for (k, effect) in study.effects.iter().enumerate().filter(|(_, e)| e.choice.is_some()) {
        for place in study.places(effect, &hypothesis.plan) {
            if is_taken(&place) {
                continue;
            }
            let unscored = |shape| Scored {
                effect: k,
                place: place.clone(),
                shape,
                amplitudes: Vec::new(),
                gain: 0.0,
                validation_gain: None,
                others: Vec::new(),
            };
            let mut all: Vec<Scored> =
                shapes(effect, |_| (0.0, 1.0)).into_iter().map(unscored).collect();
            score(search, hypothesis, &mut all);
            all.sort_by(|a, b| b.gain.total_cmp(&a.gain));
            if !all.is_empty() {
                let others = all.split_off(1);
                chosen.extend(all.pop().map(|best| Scored { others, ..best }));
            }
        }
    }
    chosen
}

/// Scores one law with several starts: the decrease that its linearised model promises from the best of them.
fn score(search: &Search<'_>, hypothesis: &Hypothesis, starts: &mut [Scored]) -> Option<()> {
    let (study, policy) = (search.study, search.policy());
    let first = starts.first()?.clone();
    let (effects, plan) = attach(study, hypothesis, &[first], 0);
    let (session, program) = study.compile(&plan, &attached(study, &effects), &[]).ok()?;
    let mut problems = Problems::new();
    let problem = Problem::new(&program, &session.sources, &plan, &study.data, &mut problems);
    let mut problem = problem?;
    problem.trimmed = problem.surplus(policy.preselection_instants);
    let used = |(k, squares): (usize, &Vec<f64>)| match problem.trimmed.contains(&k) {
        true => 0.0,
        false => squares.iter().sum::<f64>(),
    };
    let before: f64 = hypothesis.train.squares.iter().enumerate().map(used).sum();
    let share = before / hypothesis.train.total();
    // Where the sum of squares is least, the linearised model says how much less it can become.
    let mut points: Vec<(f64, usize, Vec<f64>)> = Vec::new();
    for (k, scored) in starts.iter().enumerate() {
        let (_, plan) = attach(study, hypothesis, std::slice::from_ref(scored), 0);
        let place = |(p, free): (&Parameter, &Free)| p.scale.place(free.start.unwrap_or(p.start));
        let x: Vec<f64> = problem.parameters.iter().zip(&plan.free).map(place).collect();
        if let Some(cost) = Residuals::cost(&mut problem, &x) {
            points.push((cost, k, x));
        }
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (_, k, x) in points.into_iter().take(LINEARISED_STARTS) {
        let Ok(normal) = problem.normal(&x) else { continue };
        let decrease = normal.decrease(DAMPING)?;
        starts[k].gain = (before - (normal.cost - decrease)).max(0.0) / share;
    }
    Some(())
}
