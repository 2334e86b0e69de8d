//! Several parameters that vary alike, of which one is found first, or one after the other: one phenomenon in place of
//! several effects.

use crate::calibrate::fit::refined;
use crate::calibrate::problem::Problem;

use super::alternatives::neighbours;
use super::backward_elimination::without;
use super::candidate_fit::CandidateFits;
use super::formula_fit::formula_instead;
use super::hypothesis::{ChosenEffect, Hypothesis, attach, groups};
use super::place::Place;
use super::rank::{Scored, rank_instead};
use super::result::Diagnosis;
use super::revise::{accept_first_better, accept_instead, not_fitted, stripped};
use super::search::Search;

/// Adds parameters that vary as the one that was found does, one at a time, for as long as the data support that. Its
/// amplitude is known by now, so these fits begin close to their ends, and a search for a second effect may be needless.
pub fn widen_variation(search: &Search<'_>, diagnosis: &mut Diagnosis) {
    loop {
        let after = diagnosis.after.clone();
        let is_done = after.is_resolved(search.policy()) || !search.may_continue();
        let proposals = neighbours(search, &after);
        if is_done || proposals.is_empty() {
            return;
        }
        let Some(start) = stripped(search, &after) else { return };
        let (from, proposals) = (&start, &proposals[..]);
        let fits =
            CandidateFits::new(search, from, proposals, 0).giving_up_above(after.train.total());
        let mut hypotheses = fits.run();
        hypotheses.retain(|h| h.train.total() < after.train.total());
        if !accept_first_better(search, diagnosis, hypotheses) {
            return;
        }
    }
}

/// Replaces two parameters that vary along straight lines over the same variable by one effect with a common slope, for
/// as long as the data support that.
pub fn merge_variations(search: &Search<'_>, diagnosis: &mut Diagnosis) {
    while let Some(merged) = merged(search, &diagnosis.after) {
        let limit = diagnosis.after.total_criterion() + search.policy().evidence;
        if merged.total_criterion() >= limit {
            break;
        }
        accept_instead(search, diagnosis, merged);
    }
}

/// Replaces two laws by which one parameter varies over one variable by a single curve or formula, if that explains as
/// much: both are the same law, of which the first found only a part.
pub fn merge_laws_of_one_parameter(search: &Search<'_>, diagnosis: &mut Diagnosis) {
    while let Some(single) = single_law(search, diagnosis) {
        let limit = diagnosis.after.total_criterion() + search.policy().evidence;
        if single.total_criterion() >= limit {
            break;
        }
        search.note("one law in place of two of the same parameter");
        accept_instead(search, diagnosis, single);
    }
}

/// The best hypothesis with one law in place of two that vary the same parameter over the same variable.
fn single_law(search: &Search<'_>, diagnosis: &Diagnosis) -> Option<Hypothesis> {
    let (study, after) = (search.study, &diagnosis.after);
    let all: Vec<&ChosenEffect> = groups(&after.effects).map(|group| &group[0]).collect();
    let varies = |c: &ChosenEffect| study.effects[c.effect].varies.is_some();
    let is_same = |a: &ChosenEffect, b: &ChosenEffect| {
        varies(a) && varies(b) && a.place.at == b.place.at && a.place.binds == b.place.binds
    };
    let (first, second) = all.iter().enumerate().find_map(|(j, second)| {
        let first = all[..j].iter().find(|first| is_same(first, second))?;
        Some((*first, *second))
    })?;
    let place = first.place.clone();
    let names = [first.name.clone(), second.name.clone()];
    let rest = without(study, after, &names, &mut |p| not_fitted(p))?;
    let is_law = |effect: usize, at: &Place| {
        let own = &study.effects[effect];
        own.varies.is_some() && at.at == place.at && at.binds == place.binds
    };
    let ranking = rank_instead(search, after, &rest, &is_law);
    let proposals: Vec<Vec<Scored>> = ranking.into_iter().map(|s| vec![s]).collect();
    let depth = groups(&rest.effects).count();
    let fits = CandidateFits::new(search, &rest, &proposals, depth);
    let mut hypotheses = fits.run();
    let formulas: Vec<Hypothesis> = hypotheses
        .iter()
        .filter_map(|h| formula_instead(search, h, h.effects.len().checked_sub(1)?))
        .collect();
    hypotheses.extend(formulas);
    hypotheses.into_iter().min_by(|a, b| a.total_criterion().total_cmp(&b.total_criterion()))
}

/// The best hypothesis with two of its variations in one.
fn merged(search: &Search<'_>, from: &Hypothesis) -> Option<Hypothesis> {
    let study = search.study;
    let all: Vec<_> = groups(&from.effects).map(|group| &group[0]).collect();
    let mut best: Option<Hypothesis> = None;
    for (j, second) in all.iter().enumerate() {
        for first in &all[..j] {
            let effect = &study.effects[first.effect];
            let is_line = effect.varies.is_some() && effect.amplitudes.len() == 1;
            let same = first.effect == second.effect && first.place.binds == second.place.binds;
            if !is_line || !same || effect.formula.is_some() || !search.may_continue() {
                continue;
            }
            let slope = |name: &str| Some(from.estimate(name)?.0);
            let amplitude = &effect.amplitudes[0].name;
            let slopes = [first, second].map(|c| slope(&c.full_name(amplitude)));
            let [Some(a), Some(b)] = slopes else { continue };
            let mut at = first.place.at.clone();
            at.extend(second.place.at.iter().filter(|p| !first.place.at.contains(p)).cloned());
            let place = Place { at, ..first.place.clone() };
            let names = [first.name.clone(), second.name.clone()];
            let Some(rest) = without(study, from, &names, &mut |p| not_fitted(p)) else { continue };
            let together = Scored {
                effect: first.effect,
                place,
                shape: first.fixed.clone(),
                amplitudes: vec![0.5 * (a + b)],
                gain: 0.0,
                validation_gain: None,
                others: Vec::new(),
            };
            let depth = groups(&rest.effects).count();
            let (effects, plan) = attach(study, &rest, &[together], depth);
            let policy = &search.policy().fit;
            let fit = &mut |p: &mut Problem<'_>| {
                let start = p.start();
                refined(p, policy, &start, &policy.full, &mut |_, _| search.on_step())
            };
            let Ok(mut fitted) = Hypothesis::fitted(study, effects, plan, fit) else { continue };
            fitted.is_complete_fit = true;
            let (train, validation) = (fitted.chi2_train(), fitted.chi2_validation());
            search.note(&format!("together: {train:.4}, validation {validation:.4}"));
            if best.as_ref().is_none_or(|b| fitted.total_criterion() < b.total_criterion()) {
                best = Some(fitted);
            }
        }
    }
    best
}
