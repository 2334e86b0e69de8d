//! Another law of the same variable at the same place, before a second effect: what a nearly right law leaves is more often
//! the fault of its form than a second phenomenon.

use super::candidate_fit::CandidateFits;
use super::formula_fit::formula_instead;
use super::hypothesis::Hypothesis;
use super::rank::{Scored, rank_instead};
use super::result::Diagnosis;
use super::revise::{accept_instead, stripped};
use super::search::Search;

/// Free curves at the place of the effect that are fitted.
const CURVES: usize = 2;

/// True if the fit has pushed a parameter of the plan against its bound.
fn is_at_bound(search: &Search<'_>, hypothesis: &Hypothesis) -> bool {
    let targets = search.study.plan.free.iter().filter_map(|free| free.targets.first());
    targets.into_iter().any(|target| hypothesis.is_at_bound(target))
}

/// If a single named law explains nearly everything, but not all, or only with a parameter at its bound: formulas over the variables of the free curves at the same
/// place. One that leaves nothing to explain replaces the law; one that leaves something would only bend towards what a
/// second effect does.
pub fn refine_law(search: &Search<'_>, diagnosis: &mut Diagnosis) {
    let (study, current) = (search.study, diagnosis.after.clone());
    let [chosen] = current.effects.as_slice() else { return };
    let effect = &study.effects[chosen.effect];
    let is_named = effect.varies.is_none() && effect.formula.is_none() && effect.choice.is_none();
    let is_curve = study.is_curve(chosen.effect);
    let is_resolved = current.is_resolved(search.policy()) && !is_at_bound(search, &current);
    let is_done = is_resolved || !search.leads(&diagnosis.before, &current);
    if !is_named || is_curve || is_done || !search.may_continue() {
        return;
    }
    let ranking = rank_instead(search, &current, &diagnosis.before, &|k, place| {
        let (other, is_here) = (&study.effects[k], place.at == chosen.place.at);
        is_here && other.curve.is_some() && other.varies.is_none()
    });
    let mut proposals: Vec<Vec<Scored>> = ranking.into_iter().map(|s| vec![s]).collect();
    proposals.truncate(CURVES);
    let Some(start) = stripped(search, &current) else { return };
    let from = &start;
    let fits = CandidateFits::new(search, from, &proposals, 0);
    let limit = current.total_criterion() - search.policy().evidence;
    let is_promising = |h: &Hypothesis| h.train.total() < current.train.total();
    let formulas = fits
        .run()
        .into_iter()
        .filter(is_promising)
        .filter_map(|curve| formula_instead(search, &curve, 0))
        .filter(|formula| {
            formula.total_criterion() < limit && formula.is_resolved(search.policy())
        });
    let best = formulas.min_by(|a, b| a.total_criterion().total_cmp(&b.total_criterion()));
    if let Some(best) = best {
        search.note("another law of the same variable explains more");
        accept_instead(search, diagnosis, best);
    }
}
