//! Proposals from runs that follow the recordings, where a large effect makes the score of free runs unreliable.
//!
//! Candidates are scored and fitted in a model that [followers](super::follower) pull to the recordings. The best of them
//! then start from there in free runs: the path from following to free-running of H. G. Bock, *Recent advances in parameter
//! identification techniques for ODE* (1983), where multiple shooting plays the part of the followers.

use crate::calibrate::data::Split;
use crate::calibrate::fit;
use crate::calibrate::plan::Plan;

use super::follower::{self, Follower};
use super::hypothesis::{Hypothesis, plan_without_effects};
use super::preliminary_fit::PreliminaryFits;
use super::rank::{Scored, rank_laws};
use super::rivals::trajectories;
use super::search::Search;
use super::study::Study;

/// Candidates that are fitted while they follow.
const FITTED: usize = 12;
/// Of these, those of one law.
const OF_ONE_LAW: usize = 2;
/// Free curves that are fitted besides.
const CURVES: usize = 2;
/// Those that are proposed.
const PROPOSED: usize = 2;
/// Share of what the best law leaves below which a free curve is proposed as well.
const CURVE_SHARE: f64 = 0.9;
/// How many times as much as the best one another candidate may leave to be proposed.
const NEAR: f64 = 2.0;

/// A proposal, and the plan with the values of the model's parameters from which it is fitted.
pub type Proposal = (Vec<Scored>, Plan);

/// The proposals of a search that has found nothing yet, best first.
pub fn proposals(search: &Search<'_>, from: &Hypothesis) -> Vec<Proposal> {
    if from.chi2_train() < search.policy().follow_above || !search.may_continue() {
        return Vec::new();
    }
    let Some(study) = following(search.study, from) else { return Vec::new() };
    let own = search.in_form(&study);
    let policy = &study.policy;
    let calibrated = |plan: Plan| {
        let fitted = Hypothesis::fitted(&study, Vec::new(), plan, &mut |p| {
            p.trimmed = p.surplus(policy.preselection_instants);
            let found =
                fit::search(p, &p.start(), &policy.preliminary_fit, &mut |_, _| search.on_step());
            p.trimmed = Vec::new();
            found
        });
        fitted.ok()
    };
    let found = calibrated(study.plan.clone());
    let found = found.or_else(|| calibrated(plan_without_effects(&study, from)));
    let Some(calibrated) = found else { return Vec::new() };
    let chi2 = calibrated.chi2_train();
    own.note(&format!("following the recordings: reduced chi-square {chi2:.4}"));
    if chi2 < policy.resolved_validation || !search.may_continue() {
        return Vec::new();
    }
    let ranking = rank_laws(&own, &calibrated);
    let candidates = candidates(&own, &calibrated, ranking);
    let mut fits = PreliminaryFits::new(&own, &calibrated, &candidates);
    let all = 0..candidates.len();
    fits.advance(&own, std::slice::from_ref(&all), 1);
    let left = fits.shares_left();
    let by_share = |is_wanted: &dyn Fn(usize) -> bool| {
        let mut order: Vec<usize> = all.clone().filter(|k| is_wanted(*k)).collect();
        order.retain(|k| left[*k] < policy.most_share);
        order.sort_by(|a, b| left[*a].total_cmp(&left[*b]));
        order
    };
    let is_curve = |k: usize| study.is_curve(candidates[k][0].effect);
    let mut order = by_share(&|k| !is_curve(k));
    let least = order.first().map_or(f64::INFINITY, |k| left[*k]);
    order.retain(|k| left[*k] <= NEAR * least);
    order.truncate(PROPOSED);
    let curve = by_share(&is_curve).into_iter().next();
    order.extend(curve.filter(|k| left[*k] < CURVE_SHARE * least));
    let proposal = |k: usize| {
        let labels: Vec<String> =
            candidates[k].iter().map(|s| study.label(s.effect, &s.place)).collect();
        own.note(&format!("following, {} leaves {:.2} %", labels.join(" and "), 100.0 * left[k]));
        fits.reached(k, &candidates[k])
    };
    let found: Vec<Proposal> = order.into_iter().filter_map(proposal).collect();
    let with_starts = |(proposal, reached): Proposal| {
        let mut plan = from.plan.clone();
        for free in &mut plan.free {
            let same = reached.free.iter().find(|f| f.name == free.name);
            free.start = same.map_or(free.start, |f| f.start);
        }
        (proposal, plan)
    };
    found.into_iter().map(with_starts).collect()
}

/// The candidates that promise most, but no more than a few of each law and few free curves.
fn candidates(search: &Search<'_>, from: &Hypothesis, ranking: Vec<Scored>) -> Vec<Vec<Scored>> {
    let is_curve = |s: &Scored| search.study.is_curve(s.effect);
    let mut out: Vec<Vec<Scored>> = Vec::new();
    for s in ranking.into_iter().filter(|s| s.bic_gain(from) > search.policy().evidence) {
        let of_law = out.iter().filter(|known| known[0].effect == s.effect).count();
        let of_kind = out.iter().filter(|known| is_curve(&known[0]) == is_curve(&s)).count();
        let most = if is_curve(&s) { CURVES } else { FITTED };
        if of_law < OF_ONE_LAW && of_kind < most {
            out.push(vec![s]);
        }
    }
    out
}

/// The study of the model with followers. `None` if no measured signal is a potential at a connector.
fn following(study: &Study, from: &Hypothesis) -> Option<Study> {
    let longest = study.data.of(Split::Train).max_by_key(|r| r.time.len())?;
    let flows = |m: &follower::MeasuredPotential| -> Vec<String> {
        m.ends.iter().map(|end| m.flow_at(end)).collect()
    };
    let names: Vec<String> = study.measured_potentials.iter().flat_map(flows).collect();
    let recorded = trajectories(study, from, longest, &names)?;
    let range = |values: &[f64]| {
        let (low, high) = values
            .iter()
            .filter(|x| x.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
        high - low
    };
    let follower = |m: &follower::MeasuredPotential| {
        let flow = |end: &String| {
            let name = m.flow_at(end);
            recorded.iter().find(|(n, ..)| *n == name).map_or(0.0, |(.., values)| range(values))
        };
        let end = m.ends.iter().max_by(|a, b| flow(a).total_cmp(&flow(b)))?;
        let unit = study.plan.signals[m.signal].unit;
        let values: Vec<f64> = longest.signals[m.signal].iter().map(|x| unit.to_si(*x)).collect();
        let course = follower::thinned(longest, m.signal, |x| x)?;
        let (flow, range) = (flow(end), range(&values));
        let is_usable = flow > 0.0 && flow.is_finite() && range > 0.0 && range.is_finite();
        is_usable.then(|| Follower::new(m, end, flow, range, course.spacing()))
    };
    let followers: Vec<Follower> = study.measured_potentials.iter().filter_map(follower).collect();
    if followers.is_empty() {
        return None;
    }
    let mut own = study.clone();
    for recording in &mut own.data.recordings {
        let courses = follower::courses(&followers, &study.plan, recording)?;
        recording.courses.extend(courses);
    }
    let driven: Vec<_> = followers.iter().map(|f| f.driven(&study.plan)).collect();
    own.request.recorded.extend(driven.iter().map(|d| d.input.clone()));
    own.plan.inputs.extend(driven);
    own.most_steps = std::sync::OnceLock::new();
    own.followers = followers;
    Some(own)
}
