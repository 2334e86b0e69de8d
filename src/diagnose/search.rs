//! The search for what a model lacks: calibrate, score every effect at every place, fit the best few,
//! keep what the data ask for, and look once more.

use crate::base::diag::Problems;
use crate::base::index::FastSet;
use crate::calibrate::data::{Data, Split};
use crate::calibrate::fit::{Fit, Heed, STOPPING, quick_fit, search};
use crate::calibrate::plan::{Free, Plan};
use crate::calibrate::problem::{Problem, Sums, record_also};
use crate::calibrate::statistics::standard_errors;
use crate::driver::compile::{Request, Session, Wrong};
use crate::flatten::inventory::Inventory;
use crate::ir::flat::Experiment;
use crate::ir::program::Program;
use crate::math::numeric::least_squares::Stopping;

use super::effect::{Effect, Start};
use super::place::{Place, places};
use super::score::score;
use super::text::{Attached, model};

/// Instances of effects in one model of a score test.
const BATCH: usize = 48;
/// Places that are fitted after a score test.
const FITTED: usize = 5;
/// Of these, those that are searched for long.
const SEARCHED: usize = 1;
/// Effects that are looked for, one after the other.
const DEPTH: usize = 2;
/// Decrease of the Bayesian information criterion that counts, well above what the best of hundreds of
/// places reaches by chance.
const EVIDENCE: f64 = 30.0;
/// Reduced sum of squares up to which nothing is left to explain.
pub const COMPLETE: f64 = 1.03;
/// A first look at an effect.
const LOOK: Stopping = Stopping { decrease: 1e-3, step: 1e-5, iterations: 6, reach: 1.0 };

/// What is examined.
pub struct Case<'a> {
    /// The plan.
    pub plan: &'a Plan,
    /// How its model is compiled.
    pub request: Request,
    /// The recordings.
    pub data: &'a Data,
    /// Full name of the model.
    pub base: String,
    /// What its annotation asks for.
    pub experiment: Experiment,
    /// The catalogue.
    pub effects: &'a [Effect],
    /// What the model is made of.
    pub inventory: &'a Inventory,
    /// Names of its variables.
    pub variables: &'a [String],
}

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

    /// Bayesian information criterion: sum of squares and a price for each parameter.
    pub fn bic(&self) -> f64 {
        self.train.total() + self.values.len() as f64 * (self.train.count() as f64).ln()
    }
}

/// An effect at a place with a shape, as the score test sees it.
#[derive(Clone, Debug)]
pub struct Scored {
    /// Position in the catalogue.
    pub effect: usize,
    /// Where.
    pub place: Place,
    /// Its shape.
    pub shape: Vec<(String, f64)>,
    /// The amplitudes that the score promises.
    pub amplitudes: Vec<f64>,
    /// Decrease of the sum of squares that it promises.
    pub gain: f64,
}

/// What was found.
pub struct Found {
    /// Without any effect.
    pub before: Level,
    /// With the effects that were kept.
    pub after: Level,
    /// The scores at each level, best first; one entry for each effect and place.
    pub rankings: Vec<Vec<Scored>>,
    /// What was fitted besides, best first.
    pub rejected: Vec<Level>,
}

/// Why there is no diagnosis.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Nothing {
    /// The model can not be compiled.
    Model(Wrong),
    /// It can not be run under the conditions of the recordings.
    Run,
}

/// Looks for what the model lacks. `heed` is told about each step and ends the search by `false`.
pub fn diagnose(case: &Case<'_>, heed: &mut Heed<'_>) -> Result<Found, Nothing> {
    let before = level(case, Vec::new(), case.plan.clone(), &mut |p| quick_fit(p, heed))?;
    let mut found =
        Found { after: before.clone(), before, rankings: Vec::new(), rejected: Vec::new() };
    for depth in 0..DEPTH {
        if (depth > 0 && found.after.chi2_train() < COMPLETE) || !heed(0, found.after.train.total())
        {
            break;
        }
        let ranking = rank(case, &found.after)?;
        let price = (found.after.train.count() as f64).ln();
        let promising: Vec<Scored> = ranking
            .iter()
            .filter(|s| s.gain - price * s.amplitudes.len() as f64 > EVIDENCE)
            .take(FITTED)
            .cloned()
            .collect();
        found.rankings.push(ranking);
        let mut levels: Vec<Level> = Vec::new();
        for scored in &promising {
            if !heed(0, found.after.train.total()) {
                break;
            }
            let (chosen, plan) = attach(case, &found.after, scored, depth);
            let look = &mut |p: &mut Problem<'_>| {
                let start = p.start();
                search(p, &start, &LOOK, heed)
            };
            if let Ok(fitted) = level(case, chosen, plan, look) {
                levels.push(fitted);
            }
        }
        levels.sort_by(|a, b| a.bic().total_cmp(&b.bic()));
        for fitted in levels.iter_mut().take(SEARCHED) {
            let longer = &mut |p: &mut Problem<'_>| {
                let start = p.start();
                search(p, &start, &STOPPING, heed)
            };
            if let Ok(better) = level(case, fitted.chosen.clone(), fitted.plan.clone(), longer) {
                *fitted = better;
            }
        }
        levels.sort_by(|a, b| a.bic().total_cmp(&b.bic()));
        let mut levels = levels.into_iter();
        let Some(best) = levels.next() else { break };
        let evident = best.bic() < found.after.bic() - EVIDENCE;
        let holds = best.chi2_validation() < found.after.chi2_validation();
        if evident && holds {
            found.after = best;
            found.rejected.extend(levels);
        } else {
            found.rejected.push(best);
            found.rejected.extend(levels);
            break;
        }
    }
    Ok(found)
}

/// Compiles the model with effects and fits it by `how`.
fn level(
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

pub(super) fn attached<'a>(case: &'a Case<'_>, chosen: &'a [Chosen]) -> Vec<Attached<'a>> {
    let one = |c: &'a Chosen| Attached {
        effect: &case.effects[c.effect],
        place: &c.place,
        name: c.name.clone(),
        values: c.fixed.clone(),
    };
    chosen.iter().map(one).collect()
}

/// Compiles the model with what is attached, recording the signals and `others`.
pub(super) fn compile(
    case: &Case<'_>,
    plan: &Plan,
    attached: &[Attached<'_>],
    others: &[String],
) -> Result<(Session, Program), Nothing> {
    let mut session = Session::default();
    let mut request = case.request.clone();
    if !attached.is_empty() {
        let name = "Trial";
        request.appended = Some(model(name, &case.base, "", None, &[], attached, &[]));
        request.model = Some(name.to_owned());
    }
    let mut program = session.compile(&request).map_err(Nothing::Model)?;
    if !attached.is_empty() {
        // What the annotation of the model says is not inherited.
        program.blocks.dae.experiment = case.experiment;
    }
    record_also(&mut program, plan, others);
    Ok((session, program))
}

/// Scores every effect at every place with every shape; of the shapes the best is kept.
fn rank(case: &Case<'_>, level: &Level) -> Result<Vec<Scored>, Nothing> {
    let names: FastSet<&str> = case.variables.iter().map(String::as_str).collect();
    let mut all: Vec<(usize, Place)> = Vec::new();
    for (k, effect) in case.effects.iter().enumerate() {
        for place in places(effect, case.inventory, &names, case.plan) {
            let known = level.chosen.iter().any(|c| c.effect == k && c.place == place);
            if !known {
                all.push((k, place));
            }
        }
    }
    let ranges = ranges(case, level, &all)?;
    let mut trials: Vec<Scored> = Vec::new();
    for (k, place) in &all {
        for shape in shapes(&case.effects[*k], |variable| ranges_of(&ranges, *k, place, variable)) {
            let (effect, place) = (*k, place.clone());
            trials.push(Scored { effect, place, shape, amplitudes: Vec::new(), gain: 0.0 });
        }
    }
    let mut scored: Vec<Scored> = Vec::new();
    for batch in trials.chunks_mut(BATCH) {
        score_batch(case, level, batch)?;
        for trial in batch.iter().filter(|t| t.gain > 0.0) {
            let same = |s: &&mut Scored| s.effect == trial.effect && s.place == trial.place;
            match scored.iter_mut().find(same) {
                Some(known) if known.gain >= trial.gain => {}
                Some(known) => *known = trial.clone(),
                None => scored.push(trial.clone()),
            }
        }
    }
    let price = (level.train.count() as f64).ln();
    let worth = |s: &Scored| s.gain - price * s.amplitudes.len() as f64;
    scored.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
    Ok(scored)
}

type Ranges = Vec<((usize, Place), String, (f64, f64))>;

fn ranges_of(ranges: &Ranges, effect: usize, place: &Place, variable: &str) -> (f64, f64) {
    let found = ranges.iter().find(|((k, p), v, _)| *k == effect && p == place && v == variable);
    found.map_or((0.0, 1.0), |(.., range)| *range)
}

/// The ranges that the variables of effects cover at their places.
fn ranges(case: &Case<'_>, level: &Level, all: &[(usize, Place)]) -> Result<Ranges, Nothing> {
    let mut out = Ranges::new();
    let mut wanted: Vec<(usize, &Place, Vec<String>)> = Vec::new();
    for (k, place) in all {
        let mut variables: Vec<String> = Vec::new();
        for start in case.effects[*k].shapes.iter().flat_map(|(_, starts)| starts) {
            if let Some(v) = start.variable()
                && !variables.iter().any(|known| known == v)
            {
                variables.push(v.to_owned());
            }
        }
        if !variables.is_empty() {
            wanted.push((*k, place, variables));
        }
    }
    for batch in wanted.chunks(BATCH) {
        let mut probes = attached(case, &level.chosen);
        let mut names = Vec::new();
        for (i, (k, place, variables)) in batch.iter().enumerate() {
            let name = format!("probe_{i}");
            names.extend(variables.iter().map(|v| format!("{name}.{v}")));
            let effect = &case.effects[*k];
            probes.push(Attached { effect, place, name, values: Vec::new() });
        }
        let (session, program) = compile(case, &level.plan, &probes, &names)?;
        let mut problems = Problems::new();
        let problem =
            Problem::new(&program, &session.sources, &level.plan, case.data, &mut problems);
        let problem = problem.ok_or(Nothing::Run)?;
        let found = problem.ranges(&problem.start(), &names).map_err(|_| Nothing::Run)?;
        let mut found = found.into_iter();
        for (k, place, variables) in batch {
            for v in variables {
                let range = found.next().unwrap_or((0.0, 1.0));
                out.push(((*k, (*place).clone()), v.clone(), range));
            }
        }
    }
    Ok(out)
}

/// All combinations of what the parameters of a shape start from.
fn shapes(effect: &Effect, range: impl Fn(&str) -> (f64, f64)) -> Vec<Vec<(String, f64)>> {
    let mut out = vec![Vec::new()];
    for (name, starts) in &effect.shapes {
        let values: Vec<f64> =
            starts.iter().flat_map(|s| s.values(s.variable().map_or((0.0, 1.0), &range))).collect();
        out = out
            .iter()
            .flat_map(|shape: &Vec<(String, f64)>| {
                values.iter().map(|v| {
                    let mut longer = shape.clone();
                    longer.push((name.clone(), *v));
                    longer
                })
            })
            .collect();
    }
    out
}

fn score_batch(case: &Case<'_>, level: &Level, batch: &mut [Scored]) -> Result<(), Nothing> {
    let mut all = attached(case, &level.chosen);
    let mut plan = level.plan.clone();
    let free = plan.free.len();
    let members: Vec<Vec<Place>> = batch.iter().map(|t| t.place.members()).collect();
    for (i, trial) in batch.iter().enumerate() {
        let effect = &case.effects[trial.effect];
        for (j, place) in members[i].iter().enumerate() {
            let name = format!("trial_{i}_{j}");
            for a in &effect.amplitudes {
                let full = format!("{name}.{}", a.name);
                plan.free.push(amplitude(&full, 0.0, None, place, &name));
            }
            let values = trial.shape.clone();
            all.push(Attached { effect, place, name, values });
        }
    }
    let (session, program) = compile(case, &plan, &all, &[])?;
    let mut problems = Problems::new();
    let problem = Problem::new(&program, &session.sources, &plan, case.data, &mut problems);
    let problem = problem.ok_or(Nothing::Run)?;
    let Ok(normal) = problem.normal(&problem.start()) else {
        // One that can not be run must not keep the others from it.
        let half = batch.len() / 2;
        if half > 0 {
            let (left, right) = batch.split_at_mut(half);
            score_batch(case, level, left)?;
            score_batch(case, level, right)?;
        }
        return Ok(());
    };
    let mut first = free;
    for (trial, members) in batch.iter_mut().zip(&members) {
        let effect = &case.effects[trial.effect];
        let count = members.len() * effect.amplitudes.len();
        let group: Vec<usize> = (first..first + count).collect();
        first += count;
        let signs = effect.amplitudes.iter().map(|a| a.positive);
        let positive: Vec<bool> = members.iter().flat_map(|_| signs.clone()).collect();
        if let Some(found) = score(&normal, free, &group, &positive) {
            // More than everything can not be explained: beyond its range the line does not hold.
            trial.gain = found.gain.min(level.train.total());
            trial.amplitudes = found.amplitudes;
        }
    }
    Ok(())
}

fn amplitude(full: &str, start: f64, min: Option<f64>, place: &Place, component: &str) -> Free {
    Free {
        name: full.to_owned(),
        targets: vec![full.to_owned()],
        start: Some(start),
        min,
        max: None,
        acts_on: place.signal.map(|k| (k, format!("{component}.y"))),
        span: crate::base::source::Span::NONE,
    }
}

/// The effects and the plan of a level with one more effect.
fn attach(case: &Case<'_>, level: &Level, scored: &Scored, depth: usize) -> (Vec<Chosen>, Plan) {
    let effect = &case.effects[scored.effect];
    let short = effect.class.rsplit('.').next().unwrap_or(&effect.class);
    let mut name: String = short
        .char_indices()
        .flat_map(|(i, c)| {
            let underscore = (i > 0 && c.is_uppercase()).then_some('_');
            underscore.into_iter().chain(c.to_lowercase())
        })
        .collect();
    if depth > 0 {
        name.push_str(&format!("_{}", depth + 1));
    }
    let mut plan = level.plan.clone();
    let mut chosen = level.chosen.clone();
    let members = scored.place.members();
    for (j, place) in members.iter().enumerate() {
        let component = if j == 0 { name.clone() } else { format!("{name}_at_{}", place.at[0]) };
        let starts = &scored.amplitudes[j * effect.amplitudes.len()..];
        let mut fitted = Vec::new();
        for (a, start) in effect.amplitudes.iter().zip(starts) {
            let full = format!("{component}.{}", a.name);
            let (start, min) = match a.positive {
                true if *start > 0.0 => (*start, Some(0.0)),
                true => (0.0, Some(0.0)),
                false => (*start, None),
            };
            let mut free = amplitude(&full, start, min, place, &component);
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
                let mut free = amplitude(&full, *value, None, place, &component);
                free.acts_on = None;
                plan.free.push(free);
                fitted.push(parameter.clone());
            }
        }
        if let Some(k) = place.signal {
            plan.signals[k].variable = format!("{component}.y");
        }
        let group = level.chosen.len();
        let (place, fixed) = (place.clone(), scored.shape.clone());
        chosen.push(Chosen { effect: scored.effect, place, name: component, fixed, fitted, group });
    }
    (chosen, plan)
}
