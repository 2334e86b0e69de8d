//! Preliminary fits: a few steps for each of many candidates, on few recordings.
//!
//! A large effect drags the calibration without it far away. The score is linear around trajectories that no longer pass
//! through the events of the recordings, and ranks the cause behind others. So many candidates get a little effort, from
//! the calibrated parameters or from those of the plan, and the best of them get more (successive halving: K. Jamieson,
//! A. Talwalkar, *Non-stochastic best arm identification and hyperparameter optimization*, AISTATS 2016).

use crate::base::diag::Problems;
use crate::calibrate::fit;
use crate::calibrate::parallel;
use crate::calibrate::plan::Plan;
use crate::calibrate::problem::Problem;
use crate::numeric::least_squares::Residuals;

use super::candidate_fit::{CandidateFits, amplitudes, best_start};
use super::hypothesis::{ChosenEffect, Hypothesis, attach, attached};
use super::linearise::surplus;
use super::rank::Scored;
use super::search::Search;
use super::study::Study;

/// Puts first those proposals, or named effects that promise less, of which a preliminary fit leaves little, best first.
/// Named effects whose preliminary fit leaves much more than the best are no longer proposed.
pub fn with_preliminary_fits(
    search: &Search<'_>,
    from: &Hypothesis,
    proposals: Vec<Vec<Scored>>,
    ranking: &[Scored],
) -> Vec<Vec<Scored>> {
    let policy = search.policy();
    if from.chi2_train() < policy.large_effect_above || !search.may_continue() {
        return proposals;
    }
    let mut candidates: Vec<Scored> = Vec::new();
    let promising = ranking.iter().filter(|s| s.bic_gain(from) > policy.evidence);
    for s in proposals.iter().map(|p| &p[0]).chain(promising) {
        let is_known = candidates.iter().any(|known| known.is_same(s) || known.promises_as(s));
        let is_wanted = search.study.is_named(s.effect) && !is_known;
        if is_wanted && candidates.len() < policy.preliminary_fits {
            candidates.push(s.clone());
        }
    }
    let mut fits = PreliminaryFits::new(search, from, &candidates);
    fits.advance(search, candidates.len());
    fits.advance(search, candidates.len() / HALVING);
    let left = fits.shares_left();
    let mut order: Vec<usize> = (0..candidates.len()).collect();
    order.sort_by(|a, b| left[*a].total_cmp(&left[*b]));
    let best = order.first().map_or(1.0, |k| left[*k]);
    let is_behind = |s: &Scored| {
        let own = candidates.iter().position(|c| c.is_same(s));
        own.is_some_and(|k| left[k] > policy.trailing_factor * best)
    };
    let mut out: Vec<Vec<Scored>> = Vec::new();
    for k in order.into_iter().take(policy.preferred_preliminary_fits) {
        let label = search.study.label(candidates[k].effect, &candidates[k].place);
        search.note(&format!("preliminary fit of {label}: {:.2} % left", 100.0 * left[k]));
        if left[k] < policy.most_share {
            out.push(vec![candidates[k].clone()]);
        }
    }
    let preferred = out.len();
    let is_new = |p: &Vec<Scored>| !out[..preferred].iter().any(|known| known[0].is_same(&p[0]));
    let others: Vec<Vec<Scored>> =
        proposals.into_iter().filter(|p| is_new(p) && !is_behind(&p[0])).collect();
    out.extend(others);
    out
}

/// Of so many candidates, one is continued after the first steps.
const HALVING: usize = 4;

/// Preliminary fits of candidates.
struct PreliminaryFits<'a> {
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
    fn new(search: &Search<'a>, from: &'a Hypothesis, candidates: &[Scored]) -> Self {
        search.note(&format!("preliminary fits of {} candidates", candidates.len()));
        let study = search.study;
        let fits = CandidateFits { search, from, proposals: &[], depth: 0, give_up_above: None };
        let one = |s: &Scored| {
            let (effects, plan) = attach(study, from, std::slice::from_ref(s), 0);
            let planned = from.effects.is_empty().then(|| fits.with_planned_starts(&plan));
            let starts = std::iter::once(plan).chain(planned).collect();
            PreliminaryFit { effects, starts, left: f64::INFINITY }
        };
        PreliminaryFits { study, from, fits: candidates.iter().map(one).collect() }
    }

    /// Shares of the sum of squares that they leave.
    fn shares_left(&self) -> Vec<f64> {
        self.fits.iter().map(|f| f.left).collect()
    }

    /// A few steps of the best `count`.
    fn advance(&mut self, search: &Search<'_>, count: usize) {
        let left = self.shares_left();
        let mut order: Vec<usize> = (0..self.fits.len()).collect();
        order.sort_by(|a, b| left[*a].total_cmp(&left[*b]));
        order.truncate(count);
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
