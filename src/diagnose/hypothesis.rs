//! Hypotheses: the model with certain effects at certain places, fitted to the recordings.

use crate::base::diag::Problems;
use crate::base::index::FastSet;
use crate::base::source::Span;
use crate::calibrate::data::Split;
use crate::calibrate::fit::Fit;
use crate::calibrate::plan::{Free, Plan};
use crate::calibrate::problem::Problem;
use crate::calibrate::statistics::{Statistics, errors_beside};
use crate::calibrate::sums::Sums;

use super::catalogue::{Amplitude, SENSOR_INPUT, Start};
use super::law_choice::Choice;
use super::model_source::Attached;
use super::place::Place;
use super::policy::SearchPolicy;
use super::rank::Scored;
use super::study::{DiagnosisError, Study};

/// Factor around its start within which a positive parameter of an effect is searched.
pub const RANGE: f64 = 50.0;

/// Least value of one of several amplitudes that need not be positive: each may change its sign, while a single one keeps that
/// which its score promises.
pub const ANY_SIGN: f64 = f64::NEG_INFINITY;

/// Standard errors by which an amplitude that is known differs from 0.
const KNOWN: f64 = 2.0;

/// An effect of a hypothesis.
#[derive(Clone, Debug)]
pub struct ChosenEffect {
    /// Position in the catalogue.
    pub effect: usize,
    /// Where it is attached.
    pub place: Place,
    /// Its name; for an effect with a component of its own, that of the component.
    pub name: String,
    /// The component whose parameters are those of the effect; empty for the model itself.
    pub prefix: String,
    /// Parameters that are not fitted, with their values.
    pub fixed: Vec<(String, f64)>,
    /// Parameters that are fitted.
    pub fitted: Vec<String>,
    /// Equal for the places of one effect at several places.
    pub group: usize,
}

impl ChosenEffect {
    /// The full name of one of its parameters or variables.
    pub fn full_name(&self, own: &str) -> String {
        full_name(&self.prefix, own)
    }
}

/// The full name of a variable of a component; an empty component is the model itself.
pub fn full_name(component: &str, own: &str) -> String {
    match component {
        "" => own.to_owned(),
        component => format!("{component}.{own}"),
    }
}

/// A fitted model with effects.
#[derive(Clone, Debug)]
pub struct Hypothesis {
    /// The effects; those of one group are adjacent.
    pub effects: Vec<ChosenEffect>,
    /// The plan with the parameters of the effects; its starts are the fitted values.
    pub plan: Plan,
    /// Fitted values, in the order of the plan's free parameters.
    pub values: Vec<f64>,
    /// Their standard errors.
    pub errors: Vec<f64>,
    /// Their covariance, row by row; zero in the rows of those at a bound.
    pub covariance: Vec<f64>,
    /// The same of the parameters of effects, relative to those of the model where nothing determines a common factor.
    pub errors_beside_model: Vec<f64>,
    /// The fit.
    pub fit: Fit,
    /// The fit was continued until nothing was left to gain.
    pub is_complete_fit: bool,
    /// Sums of squares of the training recordings.
    pub train: Sums,
    /// Sums of squares of the recordings that were never fitted.
    pub validation: Sums,
    /// Sums of squares of the recordings that no decision has seen; empty until the search has ended.
    pub test: Sums,
}

impl Hypothesis {
    /// Compiles the model with effects, and fits it by `fit`.
    pub fn fitted(
        study: &Study,
        effects: Vec<ChosenEffect>,
        mut plan: Plan,
        fit: &mut dyn FnMut(&mut Problem<'_>) -> Option<Fit>,
    ) -> Result<Hypothesis, DiagnosisError> {
        let (session, program) = study.compile(&plan, &attached(study, &effects), &[])?;
        plan.most_steps = study.most_steps.get().filter(|_| !effects.is_empty()).copied();
        let mut problems = Problems::new();
        let problem = Problem::new(&program, &session.sources, &plan, &study.data, &mut problems);
        let mut problem = problem.ok_or(DiagnosisError::Simulation)?;
        let fit = fit(&mut problem).ok_or(DiagnosisError::Simulation)?;
        if effects.is_empty() && study.most_steps.get().is_none() {
            let steps = problem.steps(&fit.x).map_err(|_| DiagnosisError::Simulation)?;
            let policy = &study.policy;
            study.most_steps.get_or_init(|| policy.steps_factor * steps + policy.further_steps);
        }
        let values = problem.values(&fit.x);
        let statistics = Statistics::new(&fit.normal, &problem.parameters, &fit.x);
        let covariance = statistics.covariance_of(&problem.parameters, &values);
        let errors = statistics.errors;
        let of_model = |free: &Free| study.plan.free.iter().any(|known| known.name == free.name);
        let mut is_own: Vec<bool> = plan.free.iter().map(|free| !of_model(free)).collect();
        is_own.resize(problem.parameters.len(), false);
        let errors_beside_model = errors_beside(&fit.normal, &problem.parameters, &fit.x, &is_own);
        let train = problem.sums(Split::Train, &fit.x).map_err(|_| DiagnosisError::Simulation)?;
        // A validation recording that cannot be simulated with the fitted values counts against them.
        let validation = problem.sums(Split::Validation, &fit.x).unwrap_or_else(|_| Sums {
            squares: vec![vec![f64::INFINITY; plan.signals.len()]],
            counts: vec![vec![1; plan.signals.len()]],
        });
        for (free, value) in plan.free.iter_mut().zip(&values) {
            free.start = Some(*value);
        }
        let (is_complete_fit, test) = (false, Sums::default());
        Ok(Hypothesis {
            effects,
            plan,
            values,
            errors,
            covariance,
            errors_beside_model,
            fit,
            is_complete_fit,
            train,
            validation,
            test,
        })
    }

    /// Sums of squares of the recordings of one kind.
    pub fn sums(&self, split: Split) -> &Sums {
        match split {
            Split::Train => &self.train,
            Split::Validation => &self.validation,
            Split::Test => &self.test,
        }
    }

    /// Reduced sum of squares of the training recordings.
    pub fn chi2_train(&self) -> f64 {
        self.train.total() / self.train.count().saturating_sub(self.values.len()).max(1) as f64
    }

    /// The same for the recordings that were never fitted; without any, that of the training recordings.
    pub fn chi2_validation(&self) -> f64 {
        match self.validation.count() {
            0 => self.chi2_train(),
            n => self.validation.total() / n as f64,
        }
    }

    /// Reduced sum of squares of the recordings of one kind.
    pub fn chi2(&self, split: Split) -> f64 {
        match split {
            Split::Train => self.chi2_train(),
            Split::Validation => self.chi2_validation(),
            Split::Test => self.test.total() / self.test.count() as f64,
        }
    }

    /// True if nothing is left to explain in the training recordings.
    pub fn explains_training(&self, policy: &SearchPolicy) -> bool {
        self.chi2_train() < policy.train_limit(self.train.count())
    }

    /// True if nothing is left to explain, neither in the training recordings nor in those that were never fitted.
    pub fn is_resolved(&self, policy: &SearchPolicy) -> bool {
        let validation = policy.validation_limit(self.validation.count());
        self.explains_training(policy) && self.chi2_validation() < validation
    }

    /// The information criterion plus the sum of squares of the recordings that were never fitted.
    pub fn total_criterion(&self) -> f64 {
        self.bic() + self.validation.total()
    }

    /// True if the data determine every amplitude of its effects and, of a parameter that varies and of a formula, know one
    /// better than its size: terms that nearly cancel may be any.
    pub fn is_determined(&self, study: &Study) -> bool {
        self.effects.iter().all(|c| {
            let effect = &study.effects[c.effect];
            let estimate = |a: &Amplitude| self.estimate_beside_model(&c.full_name(&a.name));
            let mut estimates = effect.amplitudes.iter().filter_map(estimate);
            let describes = effect.is_variation() || effect.formula.is_some();
            let is_known = |(value, error): (f64, f64)| value.abs() > KNOWN * error;
            estimates.clone().all(|(_, error)| error.is_finite())
                && (!describes || estimates.any(is_known))
        })
    }

    /// True if one of its effects acts at several places.
    pub fn is_at_several_places(&self) -> bool {
        self.effects.windows(2).any(|pair| pair[0].group == pair[1].group)
    }

    /// True if the data support it instead of another: the criterion over all recordings is lower by
    /// the policy's evidence, those that were never fitted are described better, and every amplitude is
    /// determined.
    pub fn is_supported_over(&self, other: &Hypothesis, study: &Study) -> bool {
        self.total_criterion() < other.total_criterion() - study.policy.evidence
            && self.chi2_validation() < other.chi2_validation()
            && self.is_determined(study)
    }

    /// True for the same effects at the same places.
    pub fn has_same_effects(&self, other: &Hypothesis) -> bool {
        let same = |(a, b): (&ChosenEffect, &ChosenEffect)| {
            a.effect == b.effect && a.name == b.name && a.place == b.place
        };
        self.effects.len() == other.effects.len()
            && self.effects.iter().zip(&other.effects).all(same)
    }

    /// The fitted value of a parameter of the model, by its full name, and its standard error.
    pub fn estimate(&self, full: &str) -> Option<(f64, f64)> {
        let k = self.position(full)?;
        Some((self.values[k], self.errors[k]))
    }

    /// The same with the error relative to the model, where nothing determines a common factor.
    pub fn estimate_beside_model(&self, full: &str) -> Option<(f64, f64)> {
        let k = self.position(full)?;
        Some((self.values[k], self.errors_beside_model[k]))
    }

    /// The covariance of two fitted parameters of the model, by their full names.
    pub fn covariance_of(&self, one: &str, other: &str) -> Option<f64> {
        let (i, j) = (self.position(one)?, self.position(other)?);
        self.covariance.get(i * self.values.len() + j).copied()
    }

    /// The position of a parameter among the free ones.
    fn position(&self, full: &str) -> Option<usize> {
        self.plan.free.iter().position(|f| f.targets.iter().any(|t| t == full))
    }

    /// True if a fitted parameter is at a bound that it may not cross; its error then says nothing.
    pub fn is_at_bound(&self, full: &str) -> bool {
        let fitted = self.plan.free.iter().zip(&self.values);
        let own = fitted.into_iter().find(|(f, _)| f.targets.iter().any(|t| t == full));
        own.is_some_and(|(free, value)| {
            let is_near = |bound: f64| {
                bound.is_finite() && (value - bound).abs() <= 1e-6 * bound.abs().max(value.abs())
            };
            free.min.is_some_and(is_near) || free.max.is_some_and(is_near)
        })
    }

    /// Bayesian information criterion: sum of squares plus a penalty for each parameter.
    pub fn bic(&self) -> f64 {
        self.train.total() + self.values.len() as f64 * (self.train.count() as f64).ln()
    }
}

/// The effects by group: each slice is one effect at one or several places.
pub fn groups(effects: &[ChosenEffect]) -> impl Iterator<Item = &[ChosenEffect]> {
    effects.chunk_by(|a, b| a.group == b.group)
}

/// The variables that the wanted inputs of an effect are bound to at all of its places, each once.
pub fn bound_variables(group: &[ChosenEffect], is_wanted: impl Fn(&str) -> bool) -> Vec<&str> {
    let mut seen = FastSet::default();
    let all = group.iter().flat_map(|c| &c.place.binds).filter(|(own, _)| is_wanted(own));
    all.map(|(_, variable)| variable.as_str()).filter(|v| seen.insert(*v)).collect()
}

/// Effects as they are attached to the model.
pub fn attached<'a>(study: &'a Study, effects: &'a [ChosenEffect]) -> Vec<Attached<'a>> {
    let one = |c: &'a ChosenEffect| {
        let effect = &study.effects[c.effect];
        Attached::new(effect, &c.place, c.prefix.clone(), c.fixed.clone())
    };
    effects.iter().map(one).collect()
}

/// The plan without effects, whose starts are the fitted values of a hypothesis.
pub fn plan_without_effects(study: &Study, from: &Hypothesis) -> Plan {
    let mut plan = study.plan.clone();
    for free in &mut plan.free {
        let same = from.plan.free.iter().find(|f| f.name == free.name);
        free.start = same.map_or(free.start, |f| f.start);
    }
    plan
}

/// An amplitude as a free parameter.
pub fn amplitude(full: &str, start: f64, min: Option<f64>, place: &Place, component: &str) -> Free {
    Free {
        name: full.to_owned(),
        targets: vec![full.to_owned()],
        start: Some(start),
        min,
        max: None,
        around: Some(RANGE),
        acts_on: place.signal.map(|k| (k, format!("{component}.y"))),
        only: None,
        span: Span::NONE,
    }
}

/// The effects and the plan of a hypothesis with the effects of a proposal added.
pub fn attach(
    study: &Study,
    hypothesis: &Hypothesis,
    proposal: &[Scored],
    depth: usize,
) -> (Vec<ChosenEffect>, Plan) {
    let mut extended = (hypothesis.effects.clone(), hypothesis.plan.clone());
    for (k, scored) in proposal.iter().enumerate() {
        extended = attach_one(study, extended, scored, depth + k);
    }
    extended
}

/// Adds one effect, at all of its places.
fn attach_one(
    study: &Study,
    (mut chosen, mut plan): (Vec<ChosenEffect>, Plan),
    scored: &Scored,
    depth: usize,
) -> (Vec<ChosenEffect>, Plan) {
    let effect = &study.effects[scored.effect];
    if let Some(choice) = &effect.choice {
        // What the model no longer has is not fitted.
        plan.free.retain_mut(|free| {
            free.targets.retain(|target| !choice.removed.contains(target));
            !free.targets.is_empty()
        });
    }
    let name = component_name(&effect.class, depth, &chosen);
    let (known, group) = (chosen.len(), chosen.last().map_or(0, |c| c.group + 1));
    for (j, mut place) in scored.place.members().into_iter().enumerate() {
        let component = match j {
            _ if effect.choice.as_ref().is_some_and(Choice::is_of_model) => String::new(),
            _ if effect.built_in => place.at[0].clone(),
            0 => name.clone(),
            _ => format!("{name}_at_{}", place.at[0].replace(['.', '[', ']'], "_")),
        };
        let mut fitted = Vec::new();
        let starts = &scored.amplitudes[j * effect.amplitudes.len()..];
        for (a, start) in effect.amplitudes.iter().zip(starts) {
            let full = full_name(&component, &a.name);
            let (start, min) = match a.positive && !place.is_signed {
                true if *start > 0.0 => (*start, Some(0.0)),
                true => (0.0, Some(0.0)),
                false if effect.amplitudes.len() > 1 => (*start, Some(ANY_SIGN)),
                false => (*start, None),
            };
            let free = amplitude(&full, start, min, &place, &component);
            fitted.push(a.name.clone());
            // The output of a sensor effect is the signal now, so the amplitude acts through the signal.
            plan.free.push(Free { acts_on: None, ..free });
        }
        for (parameter, value) in &scored.shape {
            let own = effect.shape_parameters.iter().find(|(name, _)| name == parameter);
            if !own.is_some_and(|(_, starts)| is_fitted_shape(starts)) {
                continue;
            }
            let full = full_name(&component, parameter);
            fitted.push(parameter.clone());
            // An effect at several places shares its shape parameters.
            let first = chosen.get(known).map(|c| &c.prefix);
            let shared = first.map(|first| full_name(first, parameter));
            match plan.free.iter_mut().find(|f| Some(&f.name) == shared.as_ref()) {
                Some(free) => free.targets.push(full),
                None => {
                    let free = amplitude(&full, *value, None, &place, &component);
                    let range = effect.choice.as_ref().map(|_| Choice::range(*value));
                    let (min, max) = range.map_or((None, None), |(a, b)| (Some(a), Some(b)));
                    plan.free.push(Free { acts_on: None, min, max, ..free });
                }
            }
        }
        if let Some(k) = place.signal {
            // A sensor effect reads the output of the one that is already there.
            let output = std::mem::replace(&mut plan.signals[k].variable, format!("{component}.y"));
            let own = place.binds.iter_mut().filter(|(input, _)| input == SENSOR_INPUT);
            own.for_each(|(_, variable)| variable.clone_from(&output));
        }
        let (effect, fixed) = (scored.effect, scored.shape.clone());
        let name = match component.as_str() {
            "" => name.clone(),
            component => component.to_owned(),
        };
        let prefix = component;
        chosen.push(ChosenEffect { effect, place, name, prefix, fixed, fitted, group });
    }
    (chosen, plan)
}

/// True for a shape parameter that is fitted: one with several starts, unless it chooses a side.
fn is_fitted_shape(starts: &[Start]) -> bool {
    // Between two Integers, a step may be anywhere.
    if starts.iter().any(|s| matches!(s, Start::Between(_))) {
        return false;
    }
    let several = starts.len() > 1 || starts.iter().any(|s| matches!(s, Start::Spread(..)));
    let chooses_side = starts.iter().all(|s| matches!(s, Start::Value(v) if v.abs() == 1.0));
    several && !chooses_side
}

/// The name of the component of an effect: its class, with a number where that name is taken.
pub fn component_name(class: &str, depth: usize, chosen: &[ChosenEffect]) -> String {
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
