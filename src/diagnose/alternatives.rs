//! The alternatives to a single effect that leaves nothing to explain, fitted from its parameters: what promised as much,
//! slightly other sets of parameters, other variables, and plainer laws.

use super::candidate_fit::CandidateFits;
use super::catalogue::Amplitude;
use super::difference::as_difference;
use super::forward_selection::is_special;
use super::hypothesis::Hypothesis;
use super::place::Place;
use super::preference::{ends_with_product, ends_with_term, ends_with_value, ends_with_variation};
use super::rank::{Scored, rank_instead};
use super::result::Diagnosis;
use super::revise::{is_complex, stripped};
use super::search::{Search, accept};
use super::study::Study;

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
