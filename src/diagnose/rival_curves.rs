//! Formulas of other curves. Where one free curve describes the recordings, one elsewhere often does so nearly as well,
//! and the law may be a short formula there while it bends in the place of the first.

use super::formula_fit::{formula_instead, has_formulas};
use super::hypothesis::Hypothesis;
use super::result::Diagnosis;
use super::revise::accept_instead;
use super::search::Search;

/// Curves elsewhere whose formulas are fitted.
const CURVES: usize = 2;
/// By how much a curve elsewhere may describe the fitted recordings worse, relative to the sum of squares.
const NEAR: f64 = 0.02;

/// Replaces a single curve, or the formula in its place, by a formula elsewhere that describes the recordings better.
pub fn compare_curves(search: &Search<'_>, diagnosis: &mut Diagnosis) {
    let (study, after) = (search.study, &diagnosis.after);
    let [own] = after.effects.as_slice() else { return };
    let is_vague = study.is_curve(own.effect) || study.effects[own.effect].formula.is_some();
    if !is_vague {
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
    rivals.dedup_by(|a, b| a.has_same_effects(b));
    let limit = after.total_criterion();
    let may_continue = |_: &&Hypothesis| search.may_continue();
    let formulas = rivals.iter().take(CURVES).take_while(may_continue);
    let formulas = formulas.filter_map(|curve| formula_instead(search, curve, 0));
    let better = formulas.filter(|formula| formula.total_criterion() < limit);
    let best = better.min_by(|a, b| a.total_criterion().total_cmp(&b.total_criterion()));
    if let Some(best) = best {
        search.note("a formula elsewhere explains more");
        accept_instead(search, diagnosis, best);
    }
}
