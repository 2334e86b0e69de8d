//! Preliminary fits: a few steps for each of many candidates, on few recordings.
//!
//! A large effect drags the calibration without it far away. The score is linear around trajectories that no longer pass
//! through the events of the recordings, and ranks the cause behind others. So many candidates get a little effort, from
//! the calibrated parameters or from those of the plan, and the best of them get more (successive halving: K. Jamieson,
//! A. Talwalkar, *Non-stochastic best arm identification and hyperparameter optimization*, AISTATS 2016).

use std::ops::Range;

use crate::base::diag::Problems;
use crate::calibrate::fit;
use crate::calibrate::parallel;
use crate::calibrate::plan::Plan;
use crate::calibrate::problem::Problem;
use crate::numeric::least_squares::Residuals;

use super::candidate_fit::{CandidateFits, amplitudes, best_start};
use super::hypothesis::{ChosenEffect, Hypothesis, attach, attached};
use super::linearise::surplus;
use super::place::Place;
use super::rank::Scored;
use super::search::Search;
use super::study::Study;

/// Puts first those proposals, or others of named effects that promise less, of which a preliminary fit leaves little, best
/// first.
pub fn with_preliminary_fits(
    search: &Search<'_>,
    from: &Hypothesis,
    proposals: Vec<Vec<Scored>>,
    others: impl Iterator<Item = Vec<Scored>>,
) -> Vec<Vec<Scored>> {
    let policy = search.policy();
    if from.chi2_train() < policy.large_effect_above || !search.may_continue() {
        return proposals;
    }
    let all: Vec<Vec<Scored>> = proposals.iter().cloned().chain(others).collect();
    let mut candidates = named_candidates(search.study, &all);
    let named = candidates.len();
    candidates.extend(variations(search.study, &all));
    let mut fits = PreliminaryFits::new(search, from, &candidates);
    let kinds = [0..named, named..candidates.len()];
    fits.advance(search, &kinds, 1);
    fits.advance(search, &kinds, HALVING);
    let left = fits.shares_left();
    // Those that leave about the same, or nothing but noise, stay in the order of their scores.
    let noise = 1.0 / from.chi2_train();
    let size = |k: usize| (left[k].max(noise) / noise).ln() / EQUAL.ln();
    let by_size = |range: Range<usize>| {
        let mut order: Vec<usize> = range.collect();
        order.sort_by(|a, b| size(*a).floor().total_cmp(&size(*b).floor()));
        order
    };
    let mut order = by_size(0..named);
    order.truncate(policy.preferred_preliminary_fits);
    // A parameter that varies names nothing: it is worth a fit if it leaves less than any law that has a name.
    let least = order.first().map_or(f64::INFINITY, |k| size(*k).floor());
    let varying = by_size(named..candidates.len()).into_iter().take(PREFERRED_VARIATIONS);
    order.extend(varying.filter(|k| size(*k).floor() < least));
    let mut out: Vec<Vec<Scored>> = Vec::new();
    for k in order {
        let label = |s: &Scored| search.study.label(s.effect, &s.place);
        let labels: Vec<String> = candidates[k].iter().map(label).collect();
        let (labels, share) = (labels.join(" and "), 100.0 * left[k]);
        search.note(&format!("preliminary fit of {labels}: {share:.2} % left"));
        if left[k] < policy.most_share {
            out.push(candidates[k].clone());
            let curve = curve_of_instrument(search.study, &all, &candidates[k]);
            out.extend(curve.filter(|curve| !out.iter().any(|known| is_same(known, curve))));
        }
    }
    let is_preferred = |p: &Vec<Scored>| out.iter().any(|known| is_same(known, p));
    let rest: Vec<Vec<Scored>> = proposals.into_iter().filter(|p| !is_preferred(p)).collect();
    out.extend(rest);
    out
}

/// The free curve of the sensor or actuator that a proposal changes: where one of its laws explains something, another one may
/// explain more, which the score of the curve does not show from afar.
fn curve_of_instrument(
    study: &Study,
    all: &[Vec<Scored>],
    proposal: &[Scored],
) -> Option<Vec<Scored>> {
    let [law] = proposal else { return None };
    let acts_alike = |s: &Scored| {
        let (own, other) = (&study.effects[law.effect], &study.effects[s.effect]);
        (own.of_signal || own.acts.is_some())
            && own.of_signal == other.of_signal
            && own.acts.is_some() == other.acts.is_some()
    };
    let is_curve =
        |s: &Scored| study.is_curve(s.effect) && s.place.is_same_over(&law.place) && acts_alike(s);
    all.iter().find(|p| matches!(p.as_slice(), [s] if is_curve(s))).cloned()
}

/// The named effects that get a preliminary fit: first those that promise most, then the best of each law that is not
/// among these, since a law that acts in a small part of the range promises little from afar, and then further ones.
fn named_candidates(study: &Study, all: &[Vec<Scored>]) -> Vec<Vec<Scored>> {
    let most = study.policy.preliminary_fits;
    let mut candidates: Vec<Vec<Scored>> = Vec::new();
    let mut add = |until: usize, of_new_laws: bool| {
        for p in all {
            let is_known =
                candidates.iter().any(|known| is_same(known, p) || promises_as(known, p));
            let has_law = |known: &Vec<Scored>| {
                known.len() == p.len() && known.iter().zip(p).all(|(a, b)| a.effect == b.effect)
            };
            let is_named = p.iter().all(|s| study.is_named(s.effect));
            let is_wanted = !of_new_laws || !candidates.iter().any(has_law);
            if is_named && !is_known && is_wanted && candidates.len() < until {
                candidates.push(p.clone());
            }
        }
    };
    add(most / 2, false);
    add(most, true);
    add(most, false);
    candidates
}

/// Share of the promise of a law that follows a straight line which a simpler law at its place may promise.
const SIMPLE_SHARE: f64 = 0.95;

/// The laws, but no curves, by which parameters vary, at the places where one of them promises most. A straight line and a
/// power that grows a hundredfold promise much the same, and only fits tell them apart.
fn variations(study: &Study, all: &[Vec<Scored>]) -> Vec<Vec<Scored>> {
    let is_law = |s: &&Scored| study.effects[s.effect].is_variation() && !study.is_curve(s.effect);
    let laws = || all.iter().filter_map(|p| p.first().filter(|_| p.len() == 1)).filter(is_law);
    let mut places: Vec<&Place> = Vec::new();
    let mut out: Vec<Vec<Scored>> = Vec::new();
    for s in laws() {
        if !places.iter().any(|known| known.is_same_over(&s.place)) {
            places.push(&s.place);
        }
    }
    places.truncate(VARIED_PLACES);
    // What costs more is worth it where it promises more than the simple laws.
    let simple = |place: &Place| {
        let is_simple = |s: &&Scored| !study.effects[s.effect].follows_line;
        let here = laws().filter(|s| s.place.is_same_over(place)).filter(is_simple);
        here.map(|s| s.gain).fold(0.0, f64::max)
    };
    let is_worth_it = |s: &Scored| {
        !study.effects[s.effect].follows_line || simple(&s.place) < SIMPLE_SHARE * s.gain
    };
    for s in laws()
        .filter(|s| is_worth_it(s))
        .filter(|s| places.iter().any(|place| place.is_same_over(&s.place)))
    {
        if !out.iter().any(|known| known[0].is_same(s)) {
            out.push(vec![s.clone()]);
        }
    }
    out
}

/// True for the same effects at the same places.
fn is_same(a: &[Scored], b: &[Scored]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.is_same(b))
}

/// True for a single effect at another place where it cannot be told apart.
fn promises_as(a: &[Scored], b: &[Scored]) -> bool {
    matches!((a, b), ([a], [b]) if a.promises_as(b))
}

/// Candidates of which one leaves at most this many times as much as another leave about the same.
const EQUAL: f64 = 2.0;
/// Sets of parameters, each with a variable, at which laws of parameters that vary get a preliminary fit.
const VARIED_PLACES: usize = 8;
/// Of these laws, the ones that are fitted first.
const PREFERRED_VARIATIONS: usize = 2;
/// Of so many candidates, one is continued after the first steps.
const HALVING: usize = 4;

/// Preliminary fits of candidates.
pub struct PreliminaryFits<'a> {
    study: &'a Study,
    from: &'a Hypothesis,
    fits: Vec<PreliminaryFit>,
}

/// That of one of them.
struct PreliminaryFit {
    effects: Vec<ChosenEffect>,
    /// The plans at whose values it may start: with the amplitudes that the score promises, or what was reached.
    starts: Vec<Plan>,
    /// Share of the sum of squares that is left; infinite before the first steps or if they fail.
    left: f64,
}

impl<'a> PreliminaryFits<'a> {
    /// Those of candidates beside the effects of a hypothesis, before any steps.
    pub fn new(search: &Search<'a>, from: &'a Hypothesis, candidates: &[Vec<Scored>]) -> Self {
        search.note(&format!("preliminary fits of {} candidates", candidates.len()));
        let study = search.study;
        let fits = CandidateFits::new(search, from, &[], 0);
        let one = |proposal: &Vec<Scored>| {
            let (effects, plan) = attach(study, from, proposal, 0);
            let planned = from.effects.is_empty().then(|| fits.with_planned_starts(&plan));
            let starts = std::iter::once(plan).chain(planned).collect();
            PreliminaryFit { effects, starts, left: f64::INFINITY }
        };
        PreliminaryFits { study, from, fits: candidates.iter().map(one).collect() }
    }

    /// Shares of the sum of squares that they leave.
    pub fn shares_left(&self) -> Vec<f64> {
        self.fits.iter().map(|f| f.left).collect()
    }

    /// A candidate with the values that its fit has reached, and the plan with those of the model's parameters.
    pub fn reached(&self, k: usize, candidate: &[Scored]) -> Option<(Vec<Scored>, Plan)> {
        let fit = &self.fits[k];
        let plan = fit.starts.first()?;
        let value = |chosen: &ChosenEffect, own: &str| {
            let full = chosen.full_name(own);
            plan.free.iter().find(|f| f.targets.contains(&full))?.start
        };
        let mut new = fit.effects[self.from.effects.len()..].iter();
        let with_values = |scored: &Scored| {
            let mut scored = scored.clone();
            let effect = &self.study.effects[scored.effect];
            let members: Vec<&ChosenEffect> =
                new.by_ref().take(scored.place.members().len()).collect();
            let of = |chosen: &&ChosenEffect| {
                let all = effect.amplitudes.iter();
                all.map(|a| value(chosen, &a.name)).collect::<Vec<_>>()
            };
            let reached: Vec<Option<f64>> = members.iter().flat_map(of).collect();
            for (own, reached) in scored.amplitudes.iter_mut().zip(reached) {
                *own = reached.unwrap_or(*own);
            }
            for (parameter, own) in &mut scored.shape {
                *own = members.first().and_then(|c| value(c, parameter)).unwrap_or(*own);
            }
            scored
        };
        Some((candidate.iter().map(with_values).collect(), plan.clone()))
    }

    /// A few steps of the best of each kind, one of `among`.
    pub fn advance(&mut self, search: &Search<'_>, kinds: &[Range<usize>], among: usize) {
        let left = self.shares_left();
        let best = |kind: &Range<usize>| {
            let mut order: Vec<usize> = kind.clone().collect();
            order.sort_by(|a, b| left[*a].total_cmp(&left[*b]));
            order.truncate(kind.len().div_ceil(among));
            order
        };
        let order: Vec<usize> = kinds.iter().flat_map(best).collect();
        let one = |k: usize| self.fits[order[k]].advanced(self.study, self.from);
        let cores = parallel::cores();
        let all = parallel::map_while(cores, order.len(), || !search.is_cancelled(), one);
        for (k, reached) in order.iter().zip(all) {
            if let Some((left, plan)) = reached.flatten() {
                (self.fits[*k].left, self.fits[*k].starts) = (left, vec![plan]);
            }
        }
    }
}

impl PreliminaryFit {
    /// The share that a few steps more leave, on few recordings, and the plan with the values there. `None` if the model
    /// cannot be simulated.
    fn advanced(&self, study: &Study, from: &Hypothesis) -> Option<(f64, Plan)> {
        let policy = &study.policy;
        let all = attached(study, &self.effects);
        let (session, program) = study.compile(self.starts.first()?, &all, &[]).ok()?;
        let new = amplitudes(study, &self.effects[from.effects.len()..]);
        let mut best: Option<(f64, &Plan, Problem<'_>, Vec<f64>)> = None;
        for plan in &self.starts {
            let mut problems = Problems::new();
            let problem =
                Problem::new(&program, &session.sources, plan, &study.data, &mut problems);
            let mut problem = problem?;
            problem.jobs = 1;
            problem.trimmed = surplus(&problem, from, policy.preselection_instants);
            let shares: &[f64] = if self.left.is_finite() { &[1.0] } else { &policy.start_shares };
            let start = best_start(&mut problem, &new, shares);
            let cost = Residuals::cost(&mut problem, &start).unwrap_or(f64::INFINITY);
            if best.as_ref().is_none_or(|(least, ..)| cost < *least) {
                best = Some((cost, plan, problem, start));
            }
        }
        let (_, plan, mut problem, start) = best?;
        let found = fit::search(&mut problem, &start, &policy.preliminary_fit, &mut |_, _| true)?;
        let used = from.train.squares.iter().enumerate();
        let used = used.filter(|(k, _)| !problem.trimmed.contains(k));
        let before: f64 = used.flat_map(|(_, of_signals)| of_signals).sum();
        let mut plan = plan.clone();
        for (free, value) in plan.free.iter_mut().zip(problem.values(&found.x)) {
            free.start = Some(value);
        }
        Some((found.normal.cost / before, plan))
    }
}
