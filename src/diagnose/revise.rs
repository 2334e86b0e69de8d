//! Revision of the result of stepwise selection: pairs from better parameters, one effect swapped for
//! another, fewer effects for many, and alternatives to a single effect.

use crate::calibrate::fit::{Fit, search as local_search};
use crate::calibrate::problem::Problem;

use super::backward_elimination::without;
use super::candidate_fit::CandidateFits;
use super::catalogue::Amplitude;
use super::difference::as_difference;
use super::forward_selection::{is_special, promising};
use super::hypothesis::{ChosenEffect, Hypothesis, groups, plan_without_effects};
use super::pairwise_selection::{pairs, pairwise_selection_from};
use super::place::Place;
use super::preference::{
    ends_with_product, ends_with_sensor, ends_with_term, ends_with_value, ends_with_variation,
};
use super::rank::{Scored, rank, rank_instead};
use super::result::Diagnosis;
use super::search::{Search, accept};
use super::study::Study;

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

/// Compares a single parametric effect that leaves nothing to explain with its alternatives: from its parameters, which
/// are close to the true ones, the scores discriminate better than at the first attempt.
pub fn compare_alternatives(search: &Search<'_>, diagnosis: &mut Diagnosis) {
    let policy = search.policy();
    let current = diagnosis.after.clone();
    let explained = current.explains_training(policy) && !current.effects.is_empty();
    if !explained || is_complex(search, &current) || !search.may_continue() {
        return;
    }
    let Some(start) = stripped(search, &current) else { return };
    let of_sensor = current.effects.iter().any(|c| c.place.signal.is_some());
    let first = diagnosis.rankings.first().map_or(&[][..], Vec::as_slice);
    let greatest = first.iter().map(|s| s.gain).fold(0.0, f64::max);
    // What promised little even when everything was left to explain is no alternative.
    let was_promising = |effect: usize, place: &Place| {
        let same = |s: &&Scored| s.effect == effect && s.place == *place;
        let known = first.iter().find(same);
        known.is_none_or(|s| s.gain > policy.alternative_promise * greatest)
    };
    let ranking = rank_instead(search, &current, &diagnosis.before, &|effect, place| {
        !search.study.is_curve(effect) && was_promising(effect, place)
    });
    let is_own = |s: &Scored| s.has_all(&current.effects);
    // A law that is chosen has no score of its own here: it promises what it has explained.
    let explained = diagnosis.before.train.total() - current.train.total();
    let gain = ranking.iter().find(|s| is_own(s)).map_or(explained, |s| s.gain);
    let is_alternative = |s: &&Scored| s.gain > policy.alternative_share * gain && !is_own(s);
    // Beside parameters that vary, named laws and slightly other sets are the alternatives that matter.
    let is_varied = ends_with_variation(search.study, &current);
    let is_product = ends_with_product(search.study, &current);
    let varies = |s: &&Scored| search.study.effects[s.effect].varies.is_some();
    let mut alternatives = neighbours(search, &current);
    alternatives.extend(over_other_variables(search, &current, first));
    alternatives.extend(variations_instead(search, &current, first));
    let promising = ranking
        .iter()
        .filter(is_alternative)
        .filter(|s| !(is_varied && varies(s)))
        .take(policy.alternatives)
        .map(|s| vec![s.clone()]);
    alternatives.extend(promising);
    let equals = equally_promising(search, first, &current, &is_own);
    let is_equal = |h: &Hypothesis| equals.iter().flatten().any(|s| s.has_all(&h.effects));
    alternatives.extend(equals.iter().cloned());
    let near = 1.0 + policy.alternative_excess * (diagnosis.before.chi2_train() - 1.0);
    let fits = CandidateFits::new(search, &start, &alternatives, 0)
        .giving_up_above(2.0 * near * current.train.count() as f64);
    let (mut hypotheses, distant): (Vec<_>, Vec<_>) =
        fits.short_fits().into_iter().partition(|h| h.chi2_train() < near);
    fits.fit_fully(&mut hypotheses);
    hypotheses.sort_by(|a, b| a.total_criterion().total_cmp(&b.total_criterion()));
    // Of two that explain the same, the one at fewer places or, if it justifies its parameters, the simpler.
    let better = |h: &Hypothesis| {
        let gained = current.total_criterion() - h.total_criterion();
        let simpler = h.values.len() < current.values.len() && h.bic() < current.bic();
        let fewer = h.effects.len() < current.effects.len();
        let named = is_varied && !ends_with_variation(search.study, h);
        // A wrong value of a parameter explains more plainly what a term of an equation explains as well.
        let plainer = ends_with_term(search.study, &current) && ends_with_value(search.study, h);
        // A condition holds for a whole recording; a signal may only follow it.
        let steadier =
            is_over_condition(search.study, h) && !is_over_condition(search.study, &current);
        // The rise and the fall of a state say more than the sign of a difference that its rate follows.
        let says_rate = is_of_rate(search.study, h) && is_over_difference(&current);
        let preferred = fewer || simpler || named || plainer || steadier || says_rate;
        // Nor does a parameter that varies replace a named law that explains as much, but a product of variables if it has
        // fewer parameters.
        let is_plainer_variation = is_product && h.values.len() < current.values.len();
        let is_vague =
            !is_varied && !plainer && !is_plainer_variation && ends_with_variation(search.study, h);
        // A sensor is a rival, and blamed only if nothing else is.
        let is_last = !of_sensor && h.effects.iter().any(|c| c.place.signal.is_some());
        // What promised the same at first is a rival, and which of them was fitted first is chance: the better one stays.
        if is_equal(h) && !plainer {
            let has_more = h.values.len() > current.values.len();
            let least = if says_rate { -policy.evidence } else { 0.0 };
            return !is_last && gained > least && !has_more && !is_vague;
        }
        !is_last
            && (gained > policy.evidence || gained > -policy.evidence && preferred && !is_vague)
    };
    let best = hypotheses.iter().position(better).map(|k| hypotheses.remove(k));
    diagnosis.rejected.extend(hypotheses.into_iter().chain(distant));
    if let Some(best) = best {
        let replaced = accept(search, diagnosis, best);
        diagnosis.rejected.push(replaced);
    }
}

/// What promised as much as an effect that was found when nothing had been fitted: the first that leaves nothing to explain
/// ends the fits, and whichever of several equals comes first is chance.
fn equally_promising(
    search: &Search<'_>,
    first: &[Scored],
    current: &Hypothesis,
    is_own: &dyn Fn(&Scored) -> bool,
) -> Vec<Vec<Scored>> {
    let study = search.study;
    // A formula has no score of its own; the laws at its place have.
    let is_formula = current.effects.iter().any(|c| study.effects[c.effect].formula.is_some());
    let is_here = |s: &Scored| match current.effects.first() {
        Some(chosen) if is_formula => chosen.place == s.place && !study.is_curve(s.effect),
        _ => is_own(s),
    };
    let Some(own) = first.iter().find(|s| is_here(s)) else { return Vec::new() };
    // A straight line and a law that begins as one promise the same, at every place.
    let form = |s: &Scored| (is_special(study, s), study.effects[s.effect].follows_line);
    let mut equals: Vec<&Scored> = Vec::new();
    for s in first.iter().filter(|s| s.gain > EQUAL_PROMISE * own.gain) {
        let is_as = |known: &&Scored| {
            known.promises_as(s) || known.place.at == s.place.at && form(known) == form(s)
        };
        let is_repeated = is_here(s) || equals.iter().any(is_as);
        if equals.len() < MOST_EQUALS && !study.is_curve(s.effect) && !is_repeated {
            equals.push(s);
        }
    }
    equals.into_iter().map(|s| vec![s.clone()]).collect()
}

/// Share of the promise of an effect from which on another one promised as much.
const EQUAL_PROMISE: f64 = 0.98;
/// Most of these that are fitted.
const MOST_EQUALS: usize = 4;

/// If parameters vary: the sets that differ from theirs by one parameter, with the same amplitude, small ones first.
pub fn neighbours(search: &Search<'_>, current: &Hypothesis) -> Vec<Vec<Scored>> {
    let study = search.study;
    let [chosen] = current.effects.as_slice() else { return Vec::new() };
    let effect = &study.effects[chosen.effect];
    if effect.varies.is_none() {
        return Vec::new();
    }
    let estimate = |a: &Amplitude| Some(current.estimate(&chosen.full_name(&a.name))?.0);
    let amplitudes: Vec<f64> = effect.amplitudes.iter().filter_map(estimate).collect();
    let own = &chosen.place;
    let is_near = |place: &Place| {
        let missing = own.at.iter().filter(|p| !place.at.contains(p)).count();
        let added = place.at.iter().filter(|p| !own.at.contains(p)).count();
        place.binds == own.binds && missing + added == 1
    };
    let mut places: Vec<Place> = study.places(effect, &current.plan);
    places.retain(is_near);
    places.sort_by_key(|place| place.at.len());
    let proposal = |place| {
        let (effect, shape, amplitudes) = (chosen.effect, chosen.fixed.clone(), amplitudes.clone());
        let (gain, validation_gain, others) = (0.0, None, Vec::new());
        vec![Scored { effect, place, shape, amplitudes, gain, validation_gain, others }]
    };
    places.into_iter().map(proposal).collect()
}

/// If parameters vary: the same parameters by the same law over conditions of the plan that promised nearly as much at first,
/// since a signal may only follow a condition, as a pressure does the supply, and over variables that promised the same.
fn over_other_variables(
    search: &Search<'_>,
    current: &Hypothesis,
    first: &[Scored],
) -> Vec<Vec<Scored>> {
    let study = search.study;
    let [own] = current.effects.as_slice() else { return Vec::new() };
    if study.effects[own.effect].varies.is_none() {
        return Vec::new();
    }
    let here = first.iter().filter(|s| s.effect == own.effect && s.place.at == own.place.at);
    let is_own = |s: &&Scored| s.place.binds == own.place.binds;
    let Some(known) = here.clone().find(is_own) else { return Vec::new() };
    let is_near = |s: &&Scored| {
        let share = if is_of_conditions(study, &s.place) { NEARLY_AS_MUCH } else { AS_MUCH };
        !is_own(s) && s.gain > share * known.gain
    };
    here.filter(is_near).take(OTHER_VARIABLES).map(|s| vec![s.clone()]).collect()
}

/// If a product of variables was found: the laws with one amplitude by which a single parameter varies over one of these, that
/// promised nearly as much at first. A factor that falls with a variable looks like a product with it.
fn variations_instead(
    search: &Search<'_>,
    current: &Hypothesis,
    first: &[Scored],
) -> Vec<Vec<Scored>> {
    let study = search.study;
    let [own] = current.effects.as_slice() else { return Vec::new() };
    if !ends_with_product(study, current) {
        return Vec::new();
    }
    let known = first.iter().find(|s| s.effect == own.effect && s.place == own.place);
    let promised = known.map_or(0.0, |s| s.gain);
    let is_alike = |s: &&Scored| {
        let effect = &study.effects[s.effect];
        let is_simple = effect.is_variation() && effect.amplitudes.len() == 1;
        let is_over_own = s.place.binds.iter().all(|b| own.place.binds.iter().any(|o| o.1 == b.1));
        is_simple && is_over_own && s.gain > NEARLY_AS_MUCH * promised
    };
    first.iter().filter(is_alike).take(VARIATIONS_INSTEAD).map(|s| vec![s.clone()]).collect()
}

/// Laws of parameters that are tried in the place of a product.
const VARIATIONS_INSTEAD: usize = 5;
/// Other variables over which a law is tried.
const OTHER_VARIABLES: usize = 3;
/// Share of the promise of a law which the same law over a variable other than a condition must promise to be tried.
const AS_MUCH: f64 = 0.98;
/// The same over a condition.
const NEARLY_AS_MUCH: f64 = 0.9;

/// True for a single parameter, or set of them, that varies with a condition of the plan.
fn is_over_condition(study: &Study, hypothesis: &Hypothesis) -> bool {
    matches!(hypothesis.effects.as_slice(), [only] if is_of_conditions(study, &only.place))
}

/// True for a single parameter that differs between the rise and the fall of a state.
fn is_of_rate(study: &Study, hypothesis: &Hypothesis) -> bool {
    matches!(hypothesis.effects.as_slice(), [only] if study.effects[only.effect].is_of_rate)
}

/// True for a single effect that depends on the difference of two variables.
fn is_over_difference(hypothesis: &Hypothesis) -> bool {
    let [only] = hypothesis.effects.as_slice() else { return false };
    only.place.binds.iter().any(|(_, variable)| as_difference(variable).is_some())
}

/// True for an effect that depends on conditions of the plan alone.
fn is_of_conditions(study: &Study, place: &Place) -> bool {
    let conditions = &study.variations.conditions;
    !place.binds.is_empty() && place.binds.iter().all(|(_, over)| conditions.contains(over))
}

/// True for several effects, or a free curve.
fn is_complex(search: &Search<'_>, hypothesis: &Hypothesis) -> bool {
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
