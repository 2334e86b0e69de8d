//! Backward elimination: removes the effects of a hypothesis that the data do not support beside the others.

use crate::calibrate::fit::{Fit, search as local_search};
use crate::calibrate::plan::Free;
use crate::calibrate::problem::Problem;

use super::hypothesis::{ChosenEffect, Hypothesis, groups};
use super::revise::not_fitted;
use super::search::Search;
use super::study::Study;

/// The hypothesis without the effects that it does not need, and without the unneeded places of an effect at
/// several places.
pub fn eliminated(search: &Search<'_>, mut hypothesis: Hypothesis) -> Hypothesis {
    let policy = search.policy();
    let last = hypothesis.effects.last().map_or(0, |c| c.group);
    for group in 0..=last {
        let weak: Vec<String> = hypothesis
            .effects
            .iter()
            .filter(|c| c.group == group && is_weak(search, &hypothesis, c))
            .map(|c| c.name.clone())
            .collect();
        if weak.is_empty() || weak.len() == hypothesis.effects.len() {
            continue;
        }
        let refit = &mut |p: &mut Problem<'_>| {
            let start = p.start();
            local_search(p, &start, &policy.fit.full, &mut |_, _| search.on_step())
        };
        if let Some(without) = without(search.study, &hypothesis, &weak, refit)
            && without.total_criterion() < hypothesis.total_criterion() + policy.evidence
        {
            hypothesis = without;
        }
    }
    hypothesis
}

/// True if none of the amplitudes of an effect is far from zero.
fn is_weak(search: &Search<'_>, hypothesis: &Hypothesis, chosen: &ChosenEffect) -> bool {
    let amplitudes = &search.study.effects[chosen.effect].amplitudes;
    let weak = |name: &String| {
        let estimate = hypothesis.estimate(&chosen.full_name(name));
        let limit = search.policy().weak_below;
        !estimate.is_some_and(|(value, error)| value.abs() > limit * error)
    };
    !amplitudes.is_empty() && amplitudes.iter().all(|a| weak(&a.name))
}

/// The hypothesis without the effects whose amplitudes are all exactly zero, at their bounds: these do nothing.
pub fn without_inert(study: &Study, hypothesis: Hypothesis) -> Hypothesis {
    let is_inert = |group: &&[ChosenEffect]| {
        group.iter().all(|c| {
            let amplitudes = &study.effects[c.effect].amplitudes;
            !amplitudes.is_empty()
                && amplitudes.iter().all(|a| {
                    hypothesis
                        .estimate(&c.full_name(&a.name))
                        .is_some_and(|(value, _)| value == 0.0)
                })
        })
    };
    let inert: Vec<String> =
        groups(&hypothesis.effects).filter(is_inert).flatten().map(|c| c.name.clone()).collect();
    if inert.is_empty() {
        return hypothesis;
    }
    without(study, &hypothesis, &inert, &mut |p| not_fitted(p)).unwrap_or(hypothesis)
}

/// A hypothesis without the components of these names, fitted by `fit`.
pub fn without(
    study: &Study,
    hypothesis: &Hypothesis,
    names: &[String],
    fit: &mut dyn FnMut(&mut Problem<'_>) -> Option<Fit>,
) -> Option<Hypothesis> {
    let (removed, mut kept): (Vec<ChosenEffect>, Vec<ChosenEffect>) =
        hypothesis.effects.iter().cloned().partition(|c| names.contains(&c.name));
    let mut plan = hypothesis.plan.clone();
    let is_removed = |target: &String| {
        removed.iter().any(|c| c.fitted.iter().any(|p| *target == c.full_name(p)))
    };
    plan.free.retain_mut(|free| {
        free.targets.retain(|target| !is_removed(target));
        // A shared shape parameter is named after the first place that is left.
        if is_removed(&free.name)
            && let Some(first) = free.targets.first()
        {
            free.name.clone_from(first);
        }
        !free.targets.is_empty()
    });
    // A law that is no longer chosen gives the parameters back that it removed.
    let is_back = |free: &Free| {
        let choices = removed.iter().filter_map(|c| study.effects[c.effect].choice.as_ref());
        choices.flat_map(|choice| &choice.removed).any(|name| free.targets.contains(name))
    };
    plan.free.retain(|free| !is_back(free));
    plan.free.splice(0..0, study.plan.free.iter().filter(|free| is_back(free)).cloned());
    // Readers of the output of a removed sensor effect now read its input.
    for c in removed.iter().rev() {
        if let (Some(k), Some((_, input))) = (c.place.signal, c.place.binds.first()) {
            let output = format!("{}.y", c.name);
            let binds = kept.iter_mut().flat_map(|c| &mut c.place.binds).map(|(_, v)| v);
            let readers = binds.chain(std::iter::once(&mut plan.signals[k].variable));
            readers.filter(|v| **v == output).for_each(|v| v.clone_from(input));
        }
    }
    Hypothesis::fitted(study, kept, plan, fit).ok()
}
