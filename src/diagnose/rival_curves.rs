//! Formulas of other curves. Where one free curve describes the recordings, one elsewhere often does so nearly as well,
//! and the law may be a short formula there while it bends in the place of the first. A term of an equation over a variable
//! may stand for a parameter that varies with it: friction that fades with the temperature, an elimination that saturates.

use super::candidate_fit::CandidateFits;
use super::formula_fit::{formula_instead, has_formulas};
use super::hypothesis::{ChosenEffect, Hypothesis};
use super::place::Place;
use super::preference::ends_with_variation;
use super::rank::{Scored, rank_instead};
use super::result::Diagnosis;
use super::revise::{accept_instead, stripped};
use super::search::Search;

/// Curves elsewhere whose formulas are fitted.
const CURVES: usize = 2;
/// By how much a curve elsewhere may describe the fitted recordings worse, relative to the sum of squares.
const NEAR: f64 = 0.02;
/// Share of what a term explains which the curve of a parameter must promise.
const PROMISED_SHARE: f64 = 0.5;

/// Replaces a single curve, the formula in its place, or a term of an equation by a formula elsewhere that describes the
/// recordings better.
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
    if is_term && !has_variation {
        let curves = curves_of_parameters(search, diagnosis, own);
        rivals.extend(curves.into_iter().filter(|h| is_rival(&h)));
    }
    let may_continue = |_: &&Hypothesis| search.may_continue();
    let formulas = rivals.iter().take_while(may_continue);
    let formulas = formulas.filter_map(|curve| formula_instead(search, curve, 0));
    // A name says more than a formula of as many parameters that explains as much.
    let is_better = |formula: &Hypothesis| {
        let gained = after.total_criterion() - formula.total_criterion();
        let is_simpler = is_vague || formula.values.len() < after.values.len();
        gained > if is_simpler { 0.0 } else { search.policy().evidence }
    };
    let better = formulas.filter(is_better);
    let best = better.min_by(|a, b| a.total_criterion().total_cmp(&b.total_criterion()));
    if let Some(best) = best {
        search.note("a formula elsewhere explains more");
        accept_instead(search, diagnosis, best);
    }
}

/// Free curves of single parameters over the variable of a term that promise about as much as the term, fitted.
fn curves_of_parameters(
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
        let varies = study.effects[effect].is_variation() && has_formulas(study, effect);
        varies && single.contains(&place.at) && over(place) == over(&own.place)
    };
    let ranking = rank_instead(search, after, &diagnosis.before, &is_alike);
    let explained = diagnosis.before.train.total() - after.train.total();
    let promising = |s: &&Scored| study.is_curve(s.effect) && s.gain > PROMISED_SHARE * explained;
    let proposals: Vec<Vec<Scored>> =
        ranking.iter().filter(promising).take(CURVES).map(|s| vec![s.clone()]).collect();
    CandidateFits::new(search, &start, &proposals, 0).instead_of(&diagnosis.before).run()
}
