//! Forward selection: one effect after the other, for as long as the data support it.

use std::ops::Range;

use super::candidate_fit::CandidateFits;
use super::following;
use super::formula_fit::{allowance, formula_instead, has_formulas};
use super::held_amplitude::with_held_amplitudes;
use super::hypothesis::Hypothesis;
use super::preference::{ends_with_curve, ends_with_variation, sort_by_preference};
use super::preliminary_fit::with_preliminary_fits;
use super::rank::{Scored, rank};
use super::result::Diagnosis;
use super::search::{Search, accept};
use super::study::Study;

/// Adds effects one after the other. `depths`: the numbers of effects before each of them.
pub fn forward_selection(search: &Search<'_>, diagnosis: &mut Diagnosis, depths: Range<usize>) {
    let policy = search.policy();
    for depth in depths {
        let is_explained = match depth {
            0 => false,
            _ if depth < policy.usual_effects => diagnosis.after.explains_training(policy),
            _ => diagnosis.after.chi2_train() < policy.many_effects_above,
        };
        if is_explained || !search.may_continue() {
            break;
        }
        let ranking = rank(search, &diagnosis.after);
        let total = diagnosis.after.train.total();
        let notable = if depth < policy.usual_effects { 0.0 } else { policy.notable_share * total };
        for s in ranking.iter().take(2 * policy.fitted_places) {
            let share = 100.0 * s.gain / total;
            let label = search.study.label(s.effect, &s.place);
            search.note(&format!("  score {share:5.1} %  {label} {:?}", s.shape));
        }
        diagnosis.rankings.push(ranking.clone());
        let mut left = ranking;
        let mut accepted = false;
        // Where the first proposals describe the fitted recordings alone, the next ones are tried.
        for batch in 0..BATCHES_OF_PROPOSALS {
            let mut proposals = promising(search, &diagnosis.after, &left);
            proposals.retain(|p| p.iter().all(|s| s.gain > notable));
            let from = &diagnosis.after;
            let mut hypotheses = decisive_fits(search, from, &proposals, depth);
            let decide = |all: &[Hypothesis]| all.first().is_some_and(|h| decides(search, h));
            let may_follow = batch == 0 && from.effects.is_empty() && !decide(&hypotheses);
            let followed =
                if may_follow { following_fits(search, from, depth) } else { Vec::new() };
            let is_followed = followed.iter().any(|h| decides(search, h));
            // Preliminary fits find no more from afar than what leads already.
            let leads = followed.iter().any(|h| search.leads(from, h));
            if !followed.is_empty() {
                hypotheses.extend(followed);
                sort_by_preference(search, from, &mut hypotheses, Hypothesis::total_criterion);
            }
            let is_decided = decide(&hypotheses);
            if !is_decided && !leads {
                let is_supported = |s: &&Scored| s.bic_gain(from) > policy.evidence;
                let others = left.iter().filter(is_supported).map(|s| vec![s.clone()]);
                proposals = with_preliminary_fits(search, from, proposals, others);
            }
            if proposals.is_empty() || !search.may_continue() {
                break;
            }
            left.retain(|s| !proposals.iter().any(|p| p[0].is_same(s)));
            if !is_decided {
                let is_fitted = |p: &Vec<Scored>| {
                    let same = |h: &Hypothesis| {
                        let last = &h.effects[from.effects.len()..];
                        last.len() == p.len()
                            && last
                                .iter()
                                .zip(p)
                                .all(|(c, s)| c.effect == s.effect && c.place == s.place)
                    };
                    hypotheses.iter().any(same)
                };
                let new: Vec<Vec<Scored>> =
                    proposals.iter().filter(|p| !is_fitted(p)).cloned().collect();
                let first = std::mem::take(&mut hypotheses);
                hypotheses = CandidateFits::new(search, from, &new, depth).run();
                if !first.is_empty() {
                    hypotheses.extend(first);
                    let criterion = Hypothesis::total_criterion;
                    sort_by_preference(search, from, &mut hypotheses, criterion);
                }
            }
            hold_undetermined(search, from, &mut hypotheses);
            if let Some(ranking) = diagnosis.rankings.last() {
                with_formulas(search, from, ranking, depth, &mut hypotheses);
                with_formulas_of_curves(search, from, &mut hypotheses);
                // What free runs promise from afar says nothing beside what following runs have found.
                if !is_followed {
                    with_simpler_formula(search, from, ranking, depth, &mut hypotheses);
                }
            }
            let supported = |h: &Hypothesis| {
                let is_notable = h.train.total() < total - notable;
                h.is_supported_over(from, search.study)
                    && is_notable
                    && search.is_needed(diagnosis, h)
            };
            let best = hypotheses.iter().position(supported).map(|k| hypotheses.remove(k));
            accepted = best.is_some();
            if let Some(best) = best {
                accept(search, diagnosis, best);
            }
            diagnosis.rejected.extend(hypotheses);
            if accepted {
                break;
            }
        }
        if !accepted {
            break;
        }
    }
}

/// Share of the excess from which on what promises most is fitted before any others are looked at.
const DECISIVE_SHARE: f64 = 0.7;

/// Fits of the proposals, if the first of them promises most of the excess: preliminary fits of many others would only cost
/// time. A parameter that varies, or a product of variables, may promise as much in the place of another law.
fn decisive_fits(
    search: &Search<'_>,
    from: &Hypothesis,
    proposals: &[Vec<Scored>],
    depth: usize,
) -> Vec<Hypothesis> {
    let excess = from.train.total() - from.train.count() as f64;
    let first = proposals.first().and_then(|p| p.first());
    let is_vague = |s: &&Scored| {
        let effect = &search.study.effects[s.effect];
        effect.is_variation() || effect.is_product()
    };
    let first = first.filter(|s| !is_vague(s));
    let promised = first.map_or(0.0, |s| s.gain);
    let is_decisive = from.chi2_train() >= search.policy().large_effect_above
        && promised > DECISIVE_SHARE * excess;
    match is_decisive {
        true => CandidateFits::new(search, from, proposals, depth).run(),
        false => Vec::new(),
    }
}

/// Share of the excess that a law found in runs that follow the recordings explains in free runs, unless it is another one.
const FOLLOWED_SHARE: f64 = 0.9;

/// Fits of the proposals of runs that follow the recordings.
fn following_fits(search: &Search<'_>, from: &Hypothesis, depth: usize) -> Vec<Hypothesis> {
    let mut out: Vec<Hypothesis> = Vec::new();
    for (proposal, plan) in following::proposals(search, from) {
        let from = Hypothesis { plan, ..from.clone() };
        let proposals = [proposal];
        let fits = CandidateFits::new(search, &from, &proposals, depth);
        out.extend(fits.run_if_explained(FOLLOWED_SHARE));
        if out.last().is_some_and(|h| decides(search, h)) {
            break;
        }
    }
    out
}

/// True for a law that leaves nothing to explain.
fn decides(search: &Search<'_>, hypothesis: &Hypothesis) -> bool {
    !ends_with_curve(search.study, hypothesis) && hypothesis.is_resolved(search.policy())
}

/// Holds the amplitudes of earlier effects that nothing determines any more in the best hypothesis, if that describes the
/// recordings better.
fn hold_undetermined(search: &Search<'_>, from: &Hypothesis, hypotheses: &mut [Hypothesis]) {
    let Some(best) = hypotheses.first_mut() else { return };
    let is_better = best.total_criterion() < from.total_criterion() - search.policy().evidence
        && best.chi2_validation() < from.chi2_validation();
    if is_better && let Some(held) = with_held_amplitudes(search, from, best) {
        *best = held;
    }
}

/// Adds the best formula in the place of the best hypothesis, if that is a free curve of which other parameters take a
/// share, so that nothing determines it, or if it describes what is missing only roughly: a curve between its knots, a
/// parameter that varies along a straight line or a power. A second effect would else be found that makes up for the
/// first.
fn with_formulas(
    search: &Search<'_>,
    from: &Hypothesis,
    ranking: &[Scored],
    depth: usize,
    hypotheses: &mut Vec<Hypothesis>,
) {
    let study = search.study;
    let Some(best) = hypotheses.first() else { return };
    let is_vague = ends_with_curve(study, best) || ends_with_variation(study, best);
    let is_determined = best.is_determined(study);
    let last = best.effects.len() - 1;
    // What little a straight line leaves may as well be a second parameter that varies alike.
    let is_straight =
        !ends_with_curve(study, best) && has_formulas(study, best.effects[last].effect);
    let is_nearly_straight = is_straight && search.is_nearly_resolved(best);
    let is_done = !is_vague || best.is_resolved(search.policy()) || is_nearly_straight;
    if is_determined && is_done {
        return;
    }
    // A power has no knots, but the straight line or the curve of the same parameter has.
    let place = &best.effects[last].place;
    let has_knots = |h: &&Hypothesis| {
        let own = h.effects.get(last);
        own.is_some_and(|c| c.place == *place && has_formulas(study, c.effect))
    };
    let known = hypotheses.iter().find(has_knots).cloned();
    let is_curve = |s: &&Scored| study.is_curve(s.effect) && s.place == *place;
    let curve = || {
        let proposal = [vec![ranking.iter().find(is_curve)?.clone()]];
        CandidateFits::new(search, from, &proposal, depth).run().into_iter().next()
    };
    let Some(known) = known.or_else(curve) else { return };
    if let Some(formula) = formula_instead(search, &known, last) {
        let allowance = if is_determined { allowance(search, best, last) } else { 0.0 };
        let criterion = formula.total_criterion() - allowance;
        let is_worse = |h: &Hypothesis| h.is_determined(study) && h.total_criterion() > criterion;
        let place = hypotheses.iter().position(is_worse).unwrap_or(hypotheses.len());
        hypotheses.insert(place, formula);
    }
}

/// Adds formulas in the place of free curves that describe the fitted recordings better than the best hypothesis, where that
/// is a law which leaves something to explain: such a law bends as the curve does, and a second effect would be found that
/// makes up for it.
fn with_formulas_of_curves(
    search: &Search<'_>,
    from: &Hypothesis,
    hypotheses: &mut Vec<Hypothesis>,
) {
    let study = search.study;
    let Some(best) = hypotheses.first() else { return };
    if ends_with_curve(study, best) || best.is_resolved(search.policy()) {
        return;
    }
    let has_own_formulas =
        |h: &Hypothesis| h.effects.last().is_some_and(|c| has_formulas(study, c.effect));
    let describes_more = |h: &&Hypothesis| {
        let is_of_curve = ends_with_curve(study, h) && has_own_formulas(h);
        is_of_curve && h.train.total() < best.train.total() && search.leads(from, h)
    };
    let mut curves: Vec<Hypothesis> = hypotheses.iter().filter(describes_more).cloned().collect();
    curves.sort_by(|a, b| a.train.total().total_cmp(&b.train.total()));
    for curve in curves.iter().take(CURVES_WITH_FORMULAS) {
        if !search.may_continue() {
            break;
        }
        if let Some(formula) = formula_instead(search, curve, curve.effects.len() - 1) {
            let criterion = formula.total_criterion();
            let is_worse = |h: &Hypothesis| h.total_criterion() > criterion;
            let place = hypotheses.iter().position(is_worse).unwrap_or(hypotheses.len());
            hypotheses.insert(place, formula);
        }
    }
}

/// Free curves whose formulas are fitted beside a law.
const CURVES_WITH_FORMULAS: usize = 2;

/// Adds a formula before the best hypothesis if that leaves nothing to explain, but by a law of so many parameters that it
/// may imitate another one: the formula of the free curve elsewhere which promised more, if that has fewer parameters and
/// describes the recordings better.
fn with_simpler_formula(
    search: &Search<'_>,
    from: &Hypothesis,
    ranking: &[Scored],
    depth: usize,
    hypotheses: &mut Vec<Hypothesis>,
) {
    let study = search.study;
    let Some(best) = hypotheses.first() else { return };
    let [first @ .., last] = best.effects.as_slice() else { return };
    let is_alone = first.len() == from.effects.len();
    let is_many = last.fitted.len() >= MANY_PARAMETERS && !has_formulas(study, last.effect);
    if !is_alone || !is_many || !best.is_resolved(search.policy()) || !search.may_continue() {
        return;
    }
    let own = ranking.iter().find(|s| s.effect == last.effect && s.place == last.place);
    let promised = own.map_or(f64::INFINITY, |s| s.gain);
    let is_curve = |s: &&Scored| study.is_curve(s.effect) && has_formulas(study, s.effect);
    let promises_more = |s: &&Scored| s.gain > promised && s.place.at != last.place.at;
    let Some(curve) = ranking.iter().find(is_curve).filter(promises_more) else { return };
    let fitted = CandidateFits::new(search, from, &[vec![curve.clone()]], depth).run();
    let k = best.effects.len() - 1;
    let describes_more = |h: &&Hypothesis| h.train.total() < best.train.total();
    let fitted = fitted.first().filter(describes_more);
    let formula = fitted.and_then(|h| formula_instead(search, h, k));
    let is_simpler = |h: &Hypothesis| {
        h.values.len() < best.values.len() && h.total_criterion() < best.total_criterion()
    };
    if let Some(formula) = formula.filter(is_simpler) {
        hypotheses.insert(0, formula);
    }
}

/// Fitted parameters from which on a law may imitate another one.
const MANY_PARAMETERS: usize = 3;

/// Batches of proposals that are fitted until one is supported.
const BATCHES_OF_PROPOSALS: usize = 2;

/// The proposals, of one effect each, whose promise outweighs their parameters: those that promise most for the
/// fitted recordings, and those that promise most for all.
pub fn promising(
    search: &Search<'_>,
    hypothesis: &Hypothesis,
    ranking: &[Scored],
) -> Vec<Vec<Scored>> {
    let (study, policy) = (search.study, search.policy());
    let mut proposals: Vec<&Scored> = Vec::new();
    let (mut variations, mut choices, mut products) = (0, 0, 0);
    let most = search.generosity() * policy.fitted_places;
    for s in ranking.iter().filter(|s| s.bic_gain(hypothesis) > policy.evidence) {
        let effect = &study.effects[s.effect];
        let (varies, is_choice) = (effect.is_variation(), effect.choice.is_some());
        let is_repeated = proposals.iter().any(|known| known.promises_as(s));
        if proposals.len() == most
            || is_repeated
            || varies && (variations == policy.fitted_variations || is_special(study, s))
            || effect.is_other_value()
            || is_choice && choices == policy.fitted_choices
            || effect.is_product() && products == policy.fitted_products
        {
            continue;
        }
        variations += usize::from(varies);
        choices += usize::from(is_choice);
        products += usize::from(effect.is_product());
        proposals.push(s);
    }
    special_variations(search, hypothesis, ranking, &mut proposals);
    proposals.extend(other_values(search, hypothesis, ranking));
    // Most curves are given up early once a straight line that promises nearly as much has been fitted.
    let varies = |s: &Scored| study.effects[s.effect].is_variation();
    let lines = proposals.iter().filter(|s| varies(s) && !study.is_curve(s.effect));
    let line = lines.map(|s| s.gain).fold(0.0, f64::max);
    proposals.sort_by_key(|s| {
        varies(s) && study.is_curve(s.effect) && line > policy.straight_share * s.gain
    });
    let total = |s: &Scored| s.bic_gain(hypothesis) + s.validation_gain.unwrap_or(0.0);
    let is_named =
        |s: &Scored| !study.is_curve(s.effect) && study.effects[s.effect].varies.is_none();
    let mut others: Vec<&Scored> = ranking
        .iter()
        .filter(|s| is_named(s) && s.validation_gain.is_some_and(|gain| gain > policy.evidence))
        .filter(|s| total(s) > policy.evidence && !proposals.iter().any(|known| known.is_same(s)))
        .collect();
    others.sort_by(|a, b| total(b).total_cmp(&total(a)));
    proposals.extend(others.into_iter().take(search.generosity() * policy.fitted_by_validation));
    proposals.into_iter().map(|s| vec![s.clone()]).collect()
}

/// The parameters that promise most with another value than the model gives them.
fn other_values<'r>(
    search: &Search<'_>,
    hypothesis: &Hypothesis,
    ranking: &'r [Scored],
) -> impl Iterator<Item = &'r Scored> {
    let (study, policy) = (search.study, search.policy());
    let is_value = |s: &&Scored| study.effects[s.effect].is_other_value();
    let is_supported = |s: &&Scored| s.bic_gain(hypothesis) > policy.evidence;
    ranking.iter().filter(is_value).filter(is_supported).take(policy.fitted_values)
}

/// True for a parameter that varies by a special law of the catalogue: neither along a straight line nor a free curve.
pub fn is_special(study: &Study, s: &Scored) -> bool {
    study.effects[s.effect].is_variation() && !has_formulas(study, s.effect)
}

/// Adds the special law by which a parameter varies that promises most, and the best one with a single amplitude, if it
/// promises more than a straight line over the same variable; that line comes first.
fn special_variations<'r>(
    search: &Search<'_>,
    hypothesis: &Hypothesis,
    ranking: &'r [Scored],
    proposals: &mut Vec<&'r Scored>,
) {
    let study = search.study;
    let is_supported = |s: &&Scored| s.bic_gain(hypothesis) > search.policy().evidence;
    let Some(best) = ranking.iter().filter(is_supported).find(|s| is_special(study, s)) else {
        return;
    };
    let is_line = |s: &&Scored| {
        study.effects[s.effect].is_variation()
            && !study.is_curve(s.effect)
            && !is_special(study, s)
            && s.place == best.place
    };
    let line = ranking.iter().find(is_line);
    if line.is_some_and(|line| line.gain >= best.gain) {
        return;
    }
    let at = line.and_then(|line| proposals.iter().position(|known| known.is_same(line)));
    // One with several amplitudes promises more than others, whatever the law is.
    let has_one = |s: &&Scored| study.effects[s.effect].amplitudes.len() == 1;
    let mut special = ranking.iter().filter(is_supported).filter(|s| is_special(study, s));
    let simple = special.find(has_one).filter(|s| !s.is_same(best));
    match (at, line) {
        (Some(k), _) => {
            let both = [best].into_iter().chain(simple).enumerate();
            both.for_each(|(n, s)| proposals.insert(k + 1 + n, s));
        }
        (None, line) => proposals.extend(line.into_iter().chain([best]).chain(simple)),
    }
}
