//! Other laws at the place of a law that was found, beside the rest.
//!
//! The first of several effects is chosen while the others are missing. A law with more freedom then wins because it takes a
//! share of them: a porous leak in place of a laminar one, friction with a peak in place of plain friction. Once nothing is
//! left to explain, the laws at the same place are compared again, none of them with more parameters: first those that the
//! law becomes at a limit of its own parameters, as a lag without a time constant does. A law with several parameters that
//! names no part of the machine may also imitate a formula, which is fitted then.

use super::backward_elimination::without;
use super::candidate_fit::CandidateFits;
use super::formula_fit::{curve_of, formula_instead, has_formulas, value_of_formula};
use super::hypothesis::{ChosenEffect, Hypothesis, groups};
use super::place::Place;
use super::rank::{Scored, rank_instead};
use super::regrid::ends;
use super::result::Diagnosis;
use super::revise::{accept_instead, not_fitted};
use super::search::Search;
use super::study::Study;

/// Other laws at a place that are fitted.
const SIBLINGS: usize = 3;

/// Replaces each law that was found by another one at its place that the recordings support more, with as many parameters
/// or fewer. The others are rivals, if the recordings support them as well.
pub fn compare_siblings(search: &Search<'_>, diagnosis: &mut Diagnosis) {
    let number = groups(&diagnosis.after.effects).count();
    for k in 0..number {
        let is_explained = diagnosis.after.explains_training(search.policy());
        if !is_explained || !search.may_continue() {
            return;
        }
        let mut siblings = siblings(search, diagnosis, k);
        siblings.sort_by(|a, b| a.total_criterion().total_cmp(&b.total_criterion()));
        let limit = diagnosis.after.total_criterion();
        let is_better =
            |h: &Hypothesis| h.total_criterion() < limit && h.is_determined(search.study);
        let better = siblings.iter().position(is_better).map(|k| siblings.remove(k));
        diagnosis.rejected.extend(siblings);
        if let Some(better) = better {
            search.note("another law at the same place explains as much");
            let own = groups(&diagnosis.after.effects).nth(k).map(|group| group[0].clone());
            accept_instead(search, diagnosis, better);
            // A power contains the straight line that takes its place, so it is no rival.
            if let Some(own) = own.filter(|own| contains_straight_line(search.study, own)) {
                let has_it = |c: &ChosenEffect| c.effect == own.effect && c.place == own.place;
                diagnosis.rejected.retain(|h| !h.effects.iter().any(has_it));
            }
            // Effects that it made needless are gone.
            if groups(&diagnosis.after.effects).count() != number {
                return;
            }
        }
    }
}

/// Hypotheses with another law in the place of effect `k`.
fn siblings(search: &Search<'_>, diagnosis: &Diagnosis, k: usize) -> Vec<Hypothesis> {
    let (study, after) = (search.study, &diagnosis.after);
    let own = match groups(&after.effects).nth(k) {
        Some([own]) if is_law(study, own.effect) || is_formula(study, own.effect) => own.clone(),
        Some([own]) if is_special_variation(study, own.effect) => own.clone(),
        _ => return Vec::new(),
    };
    let rest = without(study, after, std::slice::from_ref(&own.name), &mut |p| not_fitted(p));
    let Some(rest) = rest else { return Vec::new() };
    let is_simpler = |effect: usize| study.effects[own.effect].contains(&study.effects[effect]);
    let is_sibling = |effect: usize, place: &Place| {
        let is_other = is_law(study, effect)
            && parameters(study, effect) <= parameters(study, own.effect)
            && !is_known(diagnosis, &own, effect);
        // A formula by which a parameter varies gives way to a law with a name and one amplitude.
        let is_named_variation = is_formula(study, own.effect)
            && own.fitted.len() > 1
            && study.effects[own.effect].is_variation()
            && is_special_variation(study, effect)
            && study.effects[effect].amplitudes.len() == 1
            && !is_known(diagnosis, &own, effect);
        let is_wanted = is_other || is_simpler(effect) || is_named_variation;
        effect != own.effect && is_wanted && is_at(place, &own.place)
    };
    let mut ranking = rank_instead(search, after, &rest, &is_sibling);
    ranking.retain(|s| !is_known(diagnosis, &own, s.effect));
    // Another form of the same law starts from what was found: the score may not see it from afar.
    let found: Option<Vec<f64>> = (study.effects[own.effect].amplitudes.iter())
        .map(|a| after.estimate(&own.full_name(&a.name)).map(|(value, _)| value))
        .collect();
    let is_other_form =
        |s: &Scored| study.effects[s.effect].name() == study.effects[own.effect].name();
    ranking.sort_by_key(|s| !is_simpler(s.effect) && !is_other_form(s));
    for s in ranking.iter_mut().filter(|s| is_other_form(s)) {
        if let Some(found) = found.as_ref().filter(|f| f.len() == s.amplitudes.len()) {
            s.amplitudes.clone_from(found);
        }
    }
    let line = straight_line(study, diagnosis, &own);
    let siblings = line.into_iter().chain(ranking).take(SIBLINGS);
    let proposals: Vec<Vec<Scored>> = siblings.map(|s| vec![s]).collect();
    let depth = groups(&rest.effects).count();
    let fits = CandidateFits::new(search, &rest, &proposals, depth);
    let most = after.train.total() + search.policy().evidence;
    let (mut near, distant): (Vec<_>, Vec<_>) =
        fits.short_fits().into_iter().partition(|h| h.train.total() < most);
    fits.fit_fully(&mut near);
    near.extend(distant);
    // A name says more than a formula of as many parameters that explains as much.
    let says_more = |formula: &Hypothesis| {
        let gained = after.total_criterion() - formula.total_criterion();
        formula.values.len() < after.values.len() || gained > search.policy().evidence
    };
    near.extend(formula(search, after, &rest, &own).filter(says_more));
    near
}

/// Fitted parameters from which on a law may imitate a formula.
const MANY_PARAMETERS: usize = 2;

/// The hypothesis with a formula in the place of a term or of a variation of several parameters.
fn formula(
    search: &Search<'_>,
    after: &Hypothesis,
    rest: &Hypothesis,
    own: &ChosenEffect,
) -> Option<Hypothesis> {
    let study = search.study;
    let effect = &study.effects[own.effect];
    let may_imitate = effect.formula.is_none() && (effect.is_variation() || effect.adds.is_some());
    if !may_imitate || own.fitted.len() < MANY_PARAMETERS || !search.may_continue() {
        return None;
    }
    // The score of the curve follows that of the straight line.
    let is_of_kind = |k: usize, place: &Place| {
        let other = &study.effects[k];
        let is_alike = other.is_variation() == effect.is_variation()
            && other.adds.is_some() == effect.adds.is_some();
        is_alike && has_formulas(study, k) && is_at(place, &own.place)
    };
    let ranking = rank_instead(search, after, rest, &is_of_kind);
    let curve = ranking.into_iter().find(|s| study.is_curve(s.effect))?;
    let proposals = [vec![curve]];
    let depth = groups(&rest.effects).count();
    let fitted = CandidateFits::new(search, rest, &proposals, depth).run();
    let fitted = fitted.first()?;
    let k = fitted.effects.iter().position(|c| c.effect == proposals[0][0].effect)?;
    formula_instead(search, fitted, k)
}

/// True for a law by which a parameter varies that has parameters of its own beside its amplitude.
fn is_special_variation(study: &Study, effect: usize) -> bool {
    let own = &study.effects[effect];
    own.is_variation() && own.formula.is_none() && !study.is_curve(effect)
}

/// True for a power by which a parameter varies.
fn contains_straight_line(study: &Study, own: &ChosenEffect) -> bool {
    let effect = &study.effects[own.effect];
    effect.is_variation()
        && effect.formula.as_ref().is_some_and(|f| f.form.contains_straight_line())
}

/// The straight line in the place of a power by which several parameters vary together, through the ends of the power. Sets
/// of parameters that the search has put together are not scored; the line is one that was fitted for some of them.
fn straight_line(study: &Study, diagnosis: &Diagnosis, own: &ChosenEffect) -> Option<Scored> {
    if !contains_straight_line(study, own) {
        return None;
    }
    let is_line = |c: &&ChosenEffect| {
        let line = &study.effects[c.effect];
        line.is_variation()
            && line.formula.is_none()
            && !study.is_curve(c.effect)
            && !line.follows_line
            && has_formulas(study, c.effect)
            && c.place.binds == own.place.binds
            && c.place.at.iter().any(|at| own.place.at.contains(at))
    };
    let line = diagnosis.rejected.iter().rev().find_map(|h| h.effects.iter().find(is_line))?;
    let (_, curve) = curve_of(study, line.effect)?;
    let (low, high) = ends(&line.fixed, curve)?;
    let power = |x: f64| value_of_formula(study, &diagnosis.after, own, curve, x);
    Some(Scored {
        effect: line.effect,
        place: own.place.clone(),
        shape: line.fixed.clone(),
        amplitudes: vec![(1.0 + power(high)?) / (1.0 + power(low)?) - 1.0],
        gain: 0.0,
        validation_gain: None,
        others: Vec::new(),
    })
}

/// True for a law with a name of its own that is no choice of the model, no start and no value.
fn is_law(study: &Study, effect: usize) -> bool {
    let own = &study.effects[effect];
    study.is_named(effect) && own.choice.is_none() && own.starts.is_none() && own.formula.is_none()
}

/// True for a formula in the place of a free curve.
fn is_formula(study: &Study, effect: usize) -> bool {
    study.effects[effect].formula.is_some()
}

/// True for the same place, and no variables but those of the other. A further effect of a sensor reads what the last one
/// gives.
fn is_at(place: &Place, own: &Place) -> bool {
    let of_own = |name: &String| own.binds.iter().any(|(_, v)| v == name);
    place.at == own.at
        && place.signal == own.signal
        && place.connections == own.connections
        && (own.signal.is_some() || place.binds.iter().all(|(_, name)| of_own(name)))
}

fn parameters(study: &Study, effect: usize) -> usize {
    let own = &study.effects[effect];
    own.amplitudes.len() + own.shape_parameters.len()
}

/// True if the hypothesis with another law in the place of `own`, over its variables, was fitted to its end.
fn is_known(diagnosis: &Diagnosis, own: &ChosenEffect, effect: usize) -> bool {
    let after = &diagnosis.after.effects;
    let is_same = |h: &Hypothesis| {
        h.effects.len() == after.len()
            && after.iter().all(|c| {
                let wanted = if c.name == own.name { effect } else { c.effect };
                h.effects.iter().any(|o| o.effect == wanted && is_at(&o.place, &c.place))
            })
    };
    diagnosis.rejected.iter().any(|h| h.is_complete_fit && is_same(h))
}
