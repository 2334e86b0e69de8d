//! How much a claim is worth: each effect that was found is graded.

use super::hypothesis::{ChosenEffect, groups};
use super::rivals::rivals;
use super::run::Outcome;

/// The worth of an effect that was found.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Grade {
    /// A law that the recordings determine, and that no other explains as well.
    Established,
    /// A curve or a formula, or a parameter that varies: it stands for a law that is not known.
    Curve,
    /// Other effects explain the recordings as well.
    Indistinguishable,
    /// It explains most of the misfit, but the residuals still show structure: there is more to find, and that may change
    /// this.
    Partial,
}

impl Grade {
    /// Its name in `diagnosis.json`.
    pub fn name(self) -> &'static str {
        match self {
            Grade::Established => "established",
            Grade::Curve => "curve",
            Grade::Indistinguishable => "indistinguishable",
            Grade::Partial => "partial",
        }
    }

    /// What it means, for people.
    pub fn meaning(self) -> &'static str {
        match self {
            Grade::Established => "established: no other law explains the recordings as well",
            Grade::Curve => "a curve that stands for a law which is not known",
            Grade::Indistinguishable => {
                "cannot be distinguished from other effects that explain as much"
            }
            Grade::Partial => {
                "not established: it explains most of the misfit, but the residuals still show structure"
            }
        }
    }
}

/// The grade of an effect that was found; `None` for the effects of a partial explanation.
pub fn grade(outcome: &Outcome, group: &[ChosenEffect]) -> Option<Grade> {
    let (study, after) = (&outcome.study, &outcome.diagnosis.after);
    let first = group.first()?;
    if !outcome.is_explained() {
        return None;
    }
    // Rivals compete with the effect in which they differ from what was found.
    let has_it =
        |other: &[ChosenEffect]| other[0].effect == first.effect && other[0].place == first.place;
    let competes = |h: &&super::hypothesis::Hypothesis| !groups(&h.effects).any(has_it);
    if rivals(study, &outcome.diagnosis).iter().any(competes) {
        return Some(Grade::Indistinguishable);
    }
    let effect = &study.effects[first.effect];
    let is_curve = study.is_curve(first.effect) || effect.formula.is_some();
    let is_vague =
        is_curve || effect.is_variation() || effect.is_product() || !after.is_determined(study);
    Some(match outcome.diagnosis.leaves_noise(&study.policy) {
        false => Grade::Partial,
        true if is_vague => Grade::Curve,
        true => Grade::Established,
    })
}
