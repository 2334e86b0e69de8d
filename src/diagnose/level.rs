//! A model with effects, fitted: what the search climbs from one to the next.

use crate::base::diag::Problems;
use crate::base::source::Span;
use crate::calibrate::data::Split;
use crate::calibrate::fit::Fit;
use crate::calibrate::plan::{Free, Plan};
use crate::calibrate::problem::{Problem, Sums};
use crate::calibrate::statistics::standard_errors;

use super::case::{Case, Nothing, compile};
use super::effect::Start;
use super::place::Place;
use super::rank::Scored;
use super::text::Attached;

/// An effect that belongs to a level.
#[derive(Clone, Debug)]
pub struct Chosen {
    /// Position in the catalogue.
    pub effect: usize,
    /// Where it is attached.
    pub place: Place,
    /// How its component is called.
    pub name: String,
    /// Parameters that are not fitted, with their values.
    pub fixed: Vec<(String, f64)>,
    /// Parameters that are fitted.
    pub fitted: Vec<String>,
    /// The same for those that are one phenomenon at several places.
    pub group: usize,
}

/// A model with effects, fitted.
#[derive(Clone, Debug)]
pub struct Level {
    /// The effects.
    pub chosen: Vec<Chosen>,
    /// The plan with the parameters of the effects; all starts are where the fit ended.
    pub plan: Plan,
    /// Fitted values, in the order of the plan's free parameters.
    pub values: Vec<f64>,
    /// Their standard errors.
    pub errors: Vec<f64>,
    /// The fit.
    pub fit: Fit,
    /// Sums of squares of the training recordings.
    pub train: Sums,
    /// Sums of squares of the recordings that were never fitted.
    pub validation: Sums,
}

impl Level {
    /// Reduced sum of squares of the training recordings.
    pub fn chi2_train(&self) -> f64 {
        self.train.total() / self.train.count().saturating_sub(self.values.len()).max(1) as f64
    }

    /// The same of the recordings that were never fitted; of the training if there are none.
    pub fn chi2_validation(&self) -> f64 {
        match self.validation.count() {
            0 => self.chi2_train(),
            n => self.validation.total() / n as f64,
        }
    }

    /// The criterion with the recordings that were never fitted beside it.
    pub fn evidence(&self) -> f64 {
        self.bic() + self.validation.total()
    }

    /// True for the same effects at the same places.
    pub fn is_like(&self, other: &Level) -> bool {
        let what = |l: &Level| -> Vec<(usize, String)> {
            l.chosen.iter().map(|c| (c.effect, c.name.clone())).collect()
        };
        let places = self.chosen.iter().zip(&other.chosen).all(|(a, b)| a.place == b.place);
        what(self) == what(other) && places
    }

    /// The fitted value of a parameter of the model, by its full name, and its standard error.
    pub fn estimate(&self, full: &str) -> Option<(f64, f64)> {
        let k = self.plan.free.iter().position(|f| f.targets.iter().any(|t| t == full))?;
        Some((self.values[k], self.errors[k]))
    }

    /// Bayesian information criterion: sum of squares and a price for each parameter.
    pub fn bic(&self) -> f64 {
        self.train.total() + self.values.len() as f64 * (self.train.count() as f64).ln()
    }
}

/// Compiles the model with effects and fits it by `how`.
pub fn level(
    case: &Case<'_>,
    chosen: Vec<Chosen>,
    mut plan: Plan,
    how: &mut dyn FnMut(&mut Problem<'_>) -> Option<Fit>,
) -> Result<Level, Nothing> {
    let attached = attached(case, &chosen);
    let (session, program) = compile(case, &plan, &attached, &[])?;
    let mut problems = Problems::new();
    let problem = Problem::new(&program, &session.sources, &plan, case.data, &mut problems);
    let mut problem = problem.ok_or(Nothing::Run)?;
    let fit = how(&mut problem).ok_or(Nothing::Run)?;
    let values = problem.values(&fit.x);
    let errors = standard_errors(&fit.normal, &problem.parameters, &fit.x);
    let train = problem.sums(Split::Train, &fit.x).map_err(|_| Nothing::Run)?;
    // A recording that can not be run with what was fitted to the others speaks against it.
    let validation = problem.sums(Split::Validation, &fit.x).unwrap_or_else(|_| Sums {
        squares: vec![vec![f64::INFINITY; plan.signals.len()]],
        counts: vec![vec![1; plan.signals.len()]],
    });
    for (free, value) in plan.free.iter_mut().zip(&values) {
        free.start = Some(*value);
    }
    Ok(Level { chosen, plan, values, errors, fit, train, validation })
}

/// What is one phenomenon at one or several places.
pub fn groups(chosen: &[Chosen]) -> impl Iterator<Item = &[Chosen]> {
    chosen.chunk_by(|a, b| a.group == b.group)
}

/// The effects of a level as they are attached.
pub fn attached<'a>(case: &'a Case<'_>, chosen: &'a [Chosen]) -> Vec<Attached<'a>> {
    let one = |c: &'a Chosen| Attached {
        effect: &case.effects[c.effect],
        place: &c.place,
        name: c.name.clone(),
        values: c.fixed.clone(),
    };
    chosen.iter().map(one).collect()
}

/// An amplitude as a free parameter.
pub fn amplitude(full: &str, start: f64, min: Option<f64>, place: &Place, component: &str) -> Free {
    Free {
        name: full.to_owned(),
        targets: vec![full.to_owned()],
        start: Some(start),
        min,
        max: None,
        acts_on: place.signal.map(|k| (k, format!("{component}.y"))),
        span: Span::NONE,
    }
}

/// The effects and the plan of a level with more effects.
pub fn attach(
    case: &Case<'_>,
    level: &Level,
    proposal: &[Scored],
    depth: usize,
) -> (Vec<Chosen>, Plan) {
    let mut more = (level.chosen.clone(), level.plan.clone());
    for (k, scored) in proposal.iter().enumerate() {
        more = attach_one(case, more, scored, depth + k);
    }
    more
}

/// The same with one more.
fn attach_one(
    case: &Case<'_>,
    (mut chosen, mut plan): (Vec<Chosen>, Plan),
    scored: &Scored,
    depth: usize,
) -> (Vec<Chosen>, Plan) {
    let effect = &case.effects[scored.effect];
    let name = component_name(&effect.class, depth, &chosen);
    let (known, group) = (chosen.len(), chosen.last().map_or(0, |c| c.group + 1));
    let members = scored.place.members();
    for (j, mut place) in members.into_iter().enumerate() {
        let component = match j {
            _ if effect.built_in => place.at[0].clone(),
            0 => name.clone(),
            _ => format!("{name}_at_{}", place.at[0]),
        };
        let starts = &scored.amplitudes[j * effect.amplitudes.len()..];
        let mut fitted = Vec::new();
        for (a, start) in effect.amplitudes.iter().zip(starts) {
            let full = format!("{component}.{}", a.name);
            let (start, min) = match a.positive {
                true if *start > 0.0 => (*start, Some(0.0)),
                true => (0.0, Some(0.0)),
                false => (*start, None),
            };
            let mut free = amplitude(&full, start, min, &place, &component);
            // What the sensor says is the signal now.
            free.acts_on = None;
            fitted.push(a.name.clone());
            plan.free.push(free);
        }
        for ((parameter, value), (_, starts)) in scored.shape.iter().zip(&effect.shapes) {
            let several = starts.len() > 1 || starts.iter().any(|s| matches!(s, Start::Spread(..)));
            let side = starts.iter().all(|s| matches!(s, Start::Value(v) if v.abs() == 1.0));
            if several && !side {
                let full = format!("{component}.{parameter}");
                fitted.push(parameter.clone());
                // What is one phenomenon at several places has one shape.
                let first = chosen.get(known).map(|c| &c.name);
                let shared = first.map(|first| format!("{first}.{parameter}"));
                match plan.free.iter_mut().find(|f| Some(&f.name) == shared.as_ref()) {
                    Some(free) => free.targets.push(full),
                    None => {
                        let mut free = amplitude(&full, *value, None, &place, &component);
                        free.acts_on = None;
                        plan.free.push(free);
                    }
                }
            }
        }
        if let Some(k) = place.signal {
            // Behind what stands before the signal already.
            let output = std::mem::replace(&mut plan.signals[k].variable, format!("{component}.y"));
            place.binds.iter_mut().for_each(|(_, variable)| variable.clone_from(&output));
        }
        let fixed = scored.shape.clone();
        chosen.push(Chosen { effect: scored.effect, place, name: component, fixed, fitted, group });
    }
    (chosen, plan)
}

/// How the component of an effect is called: by its class, and by a number where that is taken.
fn component_name(class: &str, depth: usize, chosen: &[Chosen]) -> String {
    let short = class.rsplit('.').next().unwrap_or(class);
    let mut name: String = short
        .char_indices()
        .flat_map(|(i, c)| {
            let underscore = (i > 0 && c.is_uppercase()).then_some('_');
            underscore.into_iter().chain(c.to_lowercase())
        })
        .collect();
    if depth > 0 {
        let numbers = depth + 1..;
        let free = |n: &usize| {
            let numbered = format!("{name}_{n}");
            chosen.iter().all(|c| c.name != numbered)
        };
        let number = numbers.into_iter().find(free).unwrap_or(depth + 1);
        name.push_str(&format!("_{number}"));
    }
    name
}
