//! Revision of the result of stepwise selection: pairs from better parameters, one effect swapped for
//! another, and fewer effects for many.

use crate::calibrate::fit::{Fit, search as local_search};
use crate::calibrate::problem::Problem;

use super::backward_elimination::without;
use super::candidate_fit::CandidateFits;
use super::forward_selection::promising;
use super::hypothesis::{ChosenEffect, Hypothesis, groups, plan_without_effects};
use super::pairwise_selection::{pairs, pairwise_selection_from};
use super::preference::ends_with_sensor;
use super::rank::{Scored, rank, rank_instead};
use super::result::Diagnosis;
use super::search::{Search, accept};

/// If effects leave something to explain: pairs from the fitted parameters, then each effect swapped for
/// another beside the rest.
pub fn revise(search: &Search<'_>, diagnosis: &mut Diagnosis) {
    if diagnosis.after.is_resolved(search.policy()) || !search.may_continue() {
        return;
    }
    if let Some(stripped) = stripped(search, &diagnosis.after) {
        let ranking = rank(search, &stripped);
        pairwise_selection_from(search, diagnosis, &stripped, &ranking);
    }
    swap_effects(search, diagnosis);
}

/// If a single effect leaves much to explain: another one in its place. The parameters beside a wrong law are closer to the
/// true ones than those beside none, and so are the trajectories along which the others are scored.
pub fn select_again(search: &Search<'_>, diagnosis: &mut Diagnosis) {
    for _ in 0..RESELECTIONS {
        let after = diagnosis.after.clone();
        let is_single = groups(&after.effects).count() == 1;
        let is_done = search.leads(&diagnosis.before, &after) || after.is_resolved(search.policy());
        if !is_single || is_done || !search.may_continue() {
            return;
        }
        let Some(start) = stripped(search, &after) else { return };
        search.note("another effect in place of the one that leaves much");
        let ranking = rank_instead(search, &after, &diagnosis.before, &|_, _| true);
        let proposals = promising(search, &start, &ranking);
        let fits = CandidateFits::new(search, &start, &proposals, 0).instead_of(&diagnosis.before);
        let mut hypotheses = fits.run();
        hypotheses.retain(|h| !h.has_same_effects(&after));
        if !accept_first_better(search, diagnosis, hypotheses) {
            return;
        }
    }
}

/// Rounds in which another effect takes the place of one that leaves much.
const RESELECTIONS: usize = 2;

/// Swaps each effect for another beside the rest while that helps.
pub fn swap_effects(search: &Search<'_>, diagnosis: &mut Diagnosis) {
    for _ in 0..search.policy().swap_rounds {
        let last = diagnosis.after.bic();
        swap_step(search, diagnosis);
        if diagnosis.after.bic() >= last {
            break;
        }
    }
}

/// Swaps an effect for another one beside the rest; stops at the first swap that is better.
fn swap_step(search: &Search<'_>, diagnosis: &mut Diagnosis) {
    let number = groups(&diagnosis.after.effects).count();
    for k in 0..number {
        let done = diagnosis.after.is_resolved(search.policy()) || !search.may_continue();
        let own = groups(&diagnosis.after.effects).nth(k);
        let Some(own) = own.filter(|_| number > 1 && !done) else { return };
        let own = own.to_vec();
        let names: Vec<String> = own.iter().map(|c| c.name.clone()).collect();
        // Where a fit costs little, the scores beside the rest are those at its own parameters.
        let rest_fit = &mut |p: &mut Problem<'_>| match search.generosity() {
            1 => not_fitted(p),
            _ => {
                let (start, on_step) = (p.start(), &mut |_, _| search.on_step());
                local_search(p, &start, &search.policy().fit.quick, on_step)
            }
        };
        let rest = without(search.study, &diagnosis.after, &names, rest_fit);
        let Some(rest) = rest else { continue };
        search.note(&format!("swapping {}", names.join(", ")));
        let proposals = promising(search, &rest, &rank(search, &rest));
        let from = &rest;
        let fits = CandidateFits::new(search, from, &proposals, number - 1);
        let hypotheses = fits.run();
        // A curve or a parameter that varies follows what any law leaves: one has to leave much less to replace a name.
        let was_named = own.iter().all(|c| search.study.is_named(c.effect));
        let is_named =
            |h: &Hypothesis| h.effects.last().is_some_and(|c| search.study.is_named(c.effect));
        let excess = |h: &Hypothesis| h.chi2_train() - 1.0;
        let most = (1.0 - search.policy().explained_share) * excess(&diagnosis.after);
        let (admitted, vague): (Vec<_>, Vec<_>) =
            hypotheses.into_iter().partition(|h| !was_named || is_named(h) || excess(h) < most);
        let is_better = accept_first_better(search, diagnosis, admitted);
        diagnosis.rejected.extend(vague);
        if is_better {
            return;
        }
    }
}

/// Accepts the first hypothesis that is better than the current one; true if there is one.
pub fn accept_first_better(
    search: &Search<'_>,
    diagnosis: &mut Diagnosis,
    mut hypotheses: Vec<Hypothesis>,
) -> bool {
    let better = |h: &Hypothesis| {
        h.is_supported_over(&diagnosis.after, search.study) && search.is_needed(diagnosis, h)
    };
    let best = hypotheses.iter().position(better).map(|k| hypotheses.remove(k));
    diagnosis.rejected.extend(hypotheses);
    let Some(best) = best else { return false };
    accept_instead(search, diagnosis, best);
    true
}

/// Accepts a hypothesis, and rejects the one that it replaces if that has effects.
pub fn accept_instead(search: &Search<'_>, diagnosis: &mut Diagnosis, better: Hypothesis) {
    let replaced = accept(search, diagnosis, better);
    if !replaced.effects.is_empty() {
        diagnosis.rejected.push(replaced);
    }
}

/// Replaces several effects or a curve by a single parametric effect, or more than two effects by two, if that explains as
/// much. If no effect was accepted, the best rejected one may still have led to better parameters.
pub fn simplify(search: &Search<'_>, diagnosis: &mut Diagnosis) {
    let policy = search.policy();
    while let Some(k) = fewer_effects(search, diagnosis) {
        let fewer = diagnosis.rejected.remove(k);
        search.note("fewer effects explain as much");
        accept_instead(search, diagnosis, fewer);
    }
    let best_rejected = || diagnosis.rejected.iter().min_by(|a, b| a.bic().total_cmp(&b.bic()));
    let is_explained = diagnosis.after.explains_training(policy);
    let from = match diagnosis.after.effects.is_empty() {
        true if !is_explained => {
            best_rejected().filter(|h| h.bic() < diagnosis.after.bic() - policy.evidence)
        }
        true => None,
        false => Some(&diagnosis.after).filter(|h| is_explained && is_complex(search, h)),
    };
    if let Some(from) = from.cloned()
        && let Some(simple) = simpler(search, &from, &diagnosis.before.clone())
        && simple.chi2_validation() < diagnosis.before.chi2_validation()
    {
        accept_instead(search, diagnosis, simple);
    }
}

/// Position of the best rejected hypothesis that explains as much with fewer effects.
fn fewer_effects(search: &Search<'_>, diagnosis: &Diagnosis) -> Option<usize> {
    let after = &diagnosis.after;
    let number = groups(&after.effects).count();
    let limit = after.total_criterion() + search.policy().evidence;
    // A curve explains what several laws do, and names none of them.
    let curves = |h: &Hypothesis| {
        let is_curve = |c: &&ChosenEffect| search.study.is_curve(c.effect);
        h.effects.iter().filter(is_curve).count()
    };
    let explains = |h: &Hypothesis| {
        let own = groups(&h.effects).count();
        let is_named = curves(h) <= curves(after);
        let is_fewer = own > 0 && own < number && is_named;
        is_fewer && h.total_criterion() < limit && h.is_determined(search.study)
    };
    let all = diagnosis.rejected.iter().enumerate().filter(|(_, h)| explains(h));
    let best = all.min_by(|a, b| a.1.total_criterion().total_cmp(&b.1.total_criterion()));
    best.map(|(k, _)| k)
}

/// True for several effects, or a free curve.
pub fn is_complex(search: &Search<'_>, hypothesis: &Hypothesis) -> bool {
    let Some(first) = hypothesis.effects.first() else { return false };
    hypothesis.effects.iter().any(|c| c.group != first.group) || search.study.is_curve(first.effect)
}

/// One parametric effect in place of the effects of a hypothesis, or two: from its parameters, which are close to the true
/// ones, the scores discriminate better than at the first attempt.
fn simpler(search: &Search<'_>, from: &Hypothesis, before: &Hypothesis) -> Option<Hypothesis> {
    if !search.may_continue() {
        return None;
    }
    let study = search.study;
    let start = stripped(search, from)?;
    let fitted = |proposals: &[Vec<Scored>]| {
        let hypotheses = CandidateFits::new(search, &start, proposals, 0).instead_of(before).run();
        hypotheses.into_iter().find(|h| h.bic() < from.bic() + search.policy().evidence)
    };
    let instead = rank_instead(search, from, before, &|effect, _| !study.is_curve(effect));
    let first = promising(search, &start, &instead);
    let mut one = fitted(&first);
    let ranking = if one.is_none() { rank(search, &start) } else { Vec::new() };
    if one.is_none() {
        let is_tried = |s: &Scored| first.iter().any(|p| p[0].is_same(s));
        let others = ranking.iter().filter(|s| !study.is_curve(s.effect) && !is_tried(s));
        let others: Vec<Scored> = others.cloned().collect();
        one = fitted(&promising(search, &start, &others));
    }
    let has_curve = from.effects.iter().any(|c| study.is_curve(c.effect));
    let can_shrink = from.effects.len() > 2 || has_curve;
    // The characteristic of a sensor may be the sum of two named ones.
    let is_sum = groups(&from.effects).count() > 1 || ends_with_sensor(from);
    match one {
        None if is_sum && can_shrink => fitted(&pairs(search, &start, &ranking, 1)),
        one => one,
    }
}

/// The model without effects at the parameters of a hypothesis, not fitted again.
pub fn stripped(search: &Search<'_>, from: &Hypothesis) -> Option<Hypothesis> {
    let plan = plan_without_effects(search.study, from);
    Hypothesis::fitted(search.study, Vec::new(), plan, &mut |p| not_fitted(p)).ok()
}

/// The start itself in place of a fit.
pub fn not_fitted(problem: &mut Problem<'_>) -> Option<Fit> {
    let x = problem.start();
    let normal = problem.normal(&x).ok()?;
    Some(Fit { x, normal, iterations: 0, converged: true, beyond: None })
}
