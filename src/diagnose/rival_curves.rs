//! Formulas of other curves. Where one free curve describes the recordings, one elsewhere often does so nearly as well,
//! and the law may be a short formula there while it bends in the place of the first. A term of an equation over a variable
//! may stand for a parameter that varies with it: friction that fades with the temperature, an elimination that saturates.

use super::candidate_fit::CandidateFits;
use super::formula_fit::{formula_instead, has_formulas};
use super::hypothesis::{ChosenEffect, Hypothesis};
use super::place::Place;
use super::preference::{ends_with_curve, ends_with_variation};
use super::rank::{Scored, rank_instead};
use super::result::Diagnosis;
use super::revise::{accept_instead, stripped};
use super::search::Search;

/// Curves elsewhere whose formulas are fitted.
const CURVES: usize = 2;
/// Laws of a parameter that are fitted beside its curve.
const LAWS: usize = 2;
/// By how much a curve elsewhere may describe the fitted recordings worse, relative to the sum of squares.
const NEAR: f64 = 0.02;
/// Share of what a term explains which the curve of a parameter must promise.
const PROMISED_SHARE: f64 = 0.5;
/// The same where the term leaves something to explain, so that it may be another one.
const PROMISED_SHARE_IF_LEFT: f64 = 0.05;

/// Replaces a single curve, the formula in its place, or a term of an equation by a law elsewhere that describes the
/// recordings better: a formula, or one by which a parameter varies.
pub fn compare_curves(search: &Search<'_>, diagnosis: &mut Diagnosis) {
    let (study, after) = (search.study, &diagnosis.after);
    let [own] = after.effects.as_slice() else { return };
    let is_vague = study.is_curve(own.effect) || study.effects[own.effect].formula.is_some();
    let is_term = study.effects[own.effect].adds.is_some() && own.place.binds.len() == 1;
    if !is_vague && !is_term {
        return;
    }
    let is_rival = |h: &&Hypothesis| match h.effects.as_slice() {
        [other] => {
            study.is_curve(other.effect)
                && has_formulas(study, other.effect)
                && other.place != own.place
                && h.train.total() < (1.0 + NEAR) * after.train.total()
        }
        _ => false,
    };
    let mut rivals: Vec<Hypothesis> = diagnosis.rejected.iter().filter(is_rival).cloned().collect();
    rivals.sort_by(|a, b| a.train.total().total_cmp(&b.train.total()));
    // One curve for each place: those over other variables there are the same.
    let mut places: Vec<Vec<String>> = Vec::new();
    rivals.retain(|h| {
        let at = &h.effects[0].place.at;
        let is_new = !places.contains(at);
        if is_new {
            places.push(at.clone());
        }
        is_new
    });
    rivals.truncate(CURVES);
    let has_variation = rivals.iter().any(|h| ends_with_variation(study, h));
    let mut laws = Vec::new();
    if is_term && !has_variation {
        for h in laws_of_parameters(search, diagnosis, own) {
            match ends_with_curve(study, &h) {
                true => rivals.extend(Some(h).filter(|h| is_rival(&h))),
                false => laws.push(h),
            }
        }
    }
    let may_continue = |_: &&Hypothesis| search.may_continue();
    let formulas = rivals.iter().take_while(may_continue);
    let formulas = formulas.filter_map(|curve| formula_instead(search, curve, 0));
    // A curve gives way to another one.
    let is_curve = study.is_curve(own.effect);
    let is_determined = |h: &&Hypothesis| is_curve && h.is_determined(study);
    let formulas = formulas.chain(rivals.iter().filter(is_determined).cloned());
    // A name says more than a formula of as many parameters that explains as much.
    let is_better = |formula: &Hypothesis| {
        let gained = after.total_criterion() - formula.total_criterion();
        let is_simpler = is_vague || formula.values.len() < after.values.len();
        gained > if is_simpler { 0.0 } else { search.policy().evidence }
    };
    let laws = laws.into_iter().filter(|h| h.is_determined(study));
    let better = formulas.chain(laws).filter(is_better);
    let best = better.min_by(|a, b| a.total_criterion().total_cmp(&b.total_criterion()));
    if let Some(best) = best {
        search.note("a law elsewhere explains more");
        accept_instead(search, diagnosis, best);
    }
}

/// Does the same before a second effect is added, if a single curve or term explains nearly everything, but not all: what it
/// leaves is more often the fault of its place.
pub fn compare_curves_early(search: &Search<'_>, diagnosis: &mut Diagnosis) {
    let leads = search.leads(&diagnosis.before, &diagnosis.after);
    if leads && !diagnosis.after.is_resolved(search.policy()) && search.may_continue() {
        compare_curves(search, diagnosis);
    }
}

/// Free curves of single parameters over the variable of a term that promise about as much as the term, and the best laws at
/// the same places, fitted.
fn laws_of_parameters(
    search: &Search<'_>,
    diagnosis: &Diagnosis,
    own: &ChosenEffect,
) -> Vec<Hypothesis> {
    let (study, after) = (search.study, &diagnosis.after);
    let Some(start) = stripped(search, after).filter(|_| search.may_continue()) else {
        return Vec::new();
    };
    let single = &study.variations.parameters[..study.variations.single];
    let over = |place: &Place| place.binds.first().map(|(_, variable)| variable.clone());
    let is_alike = |effect: usize, place: &Place| {
        study.effects[effect].is_variation()
            && single.contains(&place.at)
            && over(place) == over(&own.place)
    };
    let ranking = rank_instead(search, after, &diagnosis.before, &is_alike);
    let explained = diagnosis.before.train.total() - after.train.total();
    let share = match after.is_resolved(search.policy()) {
        true => PROMISED_SHARE,
        false => PROMISED_SHARE_IF_LEFT,
    };
    let promising = |s: &&Scored| study.is_curve(s.effect) && s.gain > share * explained;
    let curves: Vec<&Scored> = ranking.iter().filter(promising).take(CURVES).collect();
    let is_here = |effect: usize, place: &Place| {
        let is_law = study.effects[effect].is_variation() && !study.is_curve(effect);
        is_law && curves.iter().any(|curve| curve.place.is_same_over(place))
    };
    let laws = rank_instead(search, after, &diagnosis.before, &is_here);
    let mut proposals: Vec<Vec<Scored>> = Vec::new();
    for curve in &curves {
        let is_own = |s: &&Scored| s.place.is_same_over(&curve.place);
        proposals.extend(laws.iter().filter(is_own).take(LAWS).map(|s| vec![s.clone()]));
        proposals.push(vec![(*curve).clone()]);
    }
    CandidateFits::new(search, &start, &proposals, 0).instead_of(&diagnosis.before).run()
}
