//! Amplitudes of earlier effects that the recordings determine no longer once another effect is added.
//!
//! An edge over which everything flows may be of any length, and a knot of a curve may be left behind by the range of its
//! variable. A further effect is not to be refused for that: such an amplitude keeps its value and is not fitted any more.

use crate::calibrate::fit::search as local_search;
use crate::calibrate::problem::Problem;

use super::hypothesis::Hypothesis;
use super::search::Search;

/// Amplitudes that are held at most, one after the other.
const MOST_HELD: usize = 6;

/// The hypothesis with those amplitudes held that nothing determines and that belong to effects of another hypothesis, from
/// which it comes; fitted again. `None` if there are none, or if others are not determined either.
pub fn with_held_amplitudes(
    search: &Search<'_>,
    from: &Hypothesis,
    hypothesis: &Hypothesis,
) -> Option<Hypothesis> {
    let policy = search.policy();
    if hypothesis.is_determined(search.study) {
        return None;
    }
    let mut held = hypothesis.clone();
    for _ in 0..MOST_HELD {
        let Some((k, name)) = undetermined(search, from, &held) else { break };
        if !search.may_continue() {
            return None;
        }
        let mut plan = held.plan.clone();
        let mut effects = held.effects.clone();
        let chosen = &mut effects[k];
        let full = chosen.full_name(&name);
        let value = value_to_hold(search, &held, k, &name)?;
        plan.free.retain(|free| !free.targets.contains(&full));
        chosen.fitted.retain(|fitted| *fitted != name);
        chosen.fixed.retain(|(fixed, _)| *fixed != name);
        chosen.fixed.push((name, value));
        held = Hypothesis::fitted(search.study, effects, plan, &mut |p: &mut Problem<'_>| {
            let start = p.start();
            local_search(p, &start, &policy.fit.quick, &mut |_, _| search.on_step())
        })
        .ok()?;
    }
    held.is_complete_fit = hypothesis.is_complete_fit;
    let is_settled = held.is_determined(search.study);
    if is_settled {
        let (train, validation) = (held.chi2_train(), held.chi2_validation());
        search
            .note(&format!("undetermined amplitudes held: {train:.4}, validation {validation:.4}"));
    }
    is_settled.then_some(held)
}

/// The first amplitude without an error that belongs to an earlier effect: the effect's position, and its name.
fn undetermined(
    search: &Search<'_>,
    from: &Hypothesis,
    held: &Hypothesis,
) -> Option<(usize, String)> {
    let is_open = |full: &str| {
        let error = held.estimate_beside_model(full).map(|(_, error)| error);
        error.is_some_and(|error| !error.is_finite())
    };
    held.effects.iter().enumerate().find_map(|(k, chosen)| {
        let is_earlier =
            from.effects.iter().any(|c| c.effect == chosen.effect && c.name == chosen.name);
        let amplitudes = search.study.effects[chosen.effect].amplitudes.iter();
        let mut open = amplitudes.filter(|a| is_earlier && is_open(&chosen.full_name(&a.name)));
        Some((k, open.next()?.name.clone()))
    })
}

/// The present value, or that of the nearest knot which is determined.
fn value_to_hold(search: &Search<'_>, held: &Hypothesis, k: usize, name: &str) -> Option<f64> {
    let chosen = &held.effects[k];
    let effect = &search.study.effects[chosen.effect];
    let of = |name: &str| held.estimate_beside_model(&chosen.full_name(name));
    let (own, _) = of(name)?;
    if effect.curve.is_none() {
        return Some(own);
    }
    let at = effect.amplitudes.iter().position(|a| a.name == name)?;
    let known = effect.amplitudes.iter().enumerate().filter_map(|(j, a)| {
        let (value, error) = of(&a.name)?;
        error.is_finite().then_some((j.abs_diff(at), value))
    });
    Some(known.min_by_key(|(distance, _)| *distance).map_or(own, |(_, value)| value))
}
