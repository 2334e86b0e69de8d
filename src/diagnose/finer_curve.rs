//! A free curve with more knots, where the one that a score test proposes is too coarse for what it describes.
//!
//! A few knots are enough to find a place, and cost few derivatives. A bell or a wave between them shows only with more, and
//! a formula is only as good as the knots that select it.

use crate::calibrate::fit::{refined, search as local_search};
use crate::calibrate::plan::Free;
use crate::calibrate::problem::Problem;

use super::catalogue::{Amplitude, Effect, Start};
use super::hypothesis::{ANY_SIGN, Hypothesis, amplitude};
use super::regrid::{ends, fitted_points, interpolated};
use super::search::Search;

/// How many times as many knots.
const FINER: usize = 2;

/// The free curves of a catalogue, with more knots.
pub fn finer_curves(effects: &[Effect]) -> Vec<Effect> {
    let finer = |(k, effect): (usize, &Effect)| {
        let curve = effect.curve.as_ref()?;
        let count = curve.count.clone()?;
        let positive = effect.amplitudes.first()?.positive;
        let n = FINER * effect.amplitudes.len();
        let knot = |k: usize| Amplitude { name: format!("{}[{k}]", curve.knots), positive };
        let mut finer = effect.clone();
        let unit =
            effect.amplitudes.first().and_then(|a| effect.units.iter().find(|(n, _)| *n == a.name));
        let unit = unit.map_or(String::new(), |(_, unit)| unit.clone());
        finer.amplitudes = (1..=n).map(knot).collect();
        finer.units.retain(|(name, _)| !effect.amplitudes.iter().any(|a| a.name == *name));
        finer.units.extend(finer.amplitudes.iter().map(|a| (a.name.clone(), unit.clone())));
        finer.shape_parameters.push((count, vec![Start::Value(n as f64)]));
        finer.finer_than = Some(k);
        Some(finer)
    };
    effects.iter().enumerate().filter_map(finer).collect()
}

/// The hypothesis with more knots for its effect `k`, a free curve that leaves something to explain, fitted. `None` if it is
/// no curve, or if the recordings do not support them.
pub fn with_finer_knots(
    search: &Search<'_>,
    hypothesis: &Hypothesis,
    k: usize,
) -> Option<Hypothesis> {
    let (study, policy) = (search.study, search.policy());
    let old = hypothesis.effects.get(k)?;
    let coarse = &study.effects[old.effect];
    let curve = coarse.curve.as_ref()?;
    if hypothesis.is_resolved(policy) || !search.may_continue() {
        return None;
    }
    let mut all = study.effects.iter().enumerate();
    let (effect, finer) = all.find(|(_, e)| e.finer_than == Some(old.effect))?;
    let ends = ends(&old.fixed, curve)?;
    let known = fitted_points(hypothesis, old, coarse, curve)?;
    let mut chosen = old.clone();
    chosen.effect = effect;
    chosen.fitted = finer.amplitudes.iter().map(|a| a.name.clone()).collect();
    let of_knots = |name: &String| coarse.amplitudes.iter().any(|a| a.name == *name);
    chosen.fixed.retain(|(name, _)| !of_knots(name));
    let number = finer.amplitudes.len();
    chosen.fixed.extend(curve.count.iter().map(|count| (count.clone(), number as f64)));
    let mut plan = hypothesis.plan.clone();
    let is_old = |name: &String| coarse.amplitudes.iter().any(|a| *name == old.full_name(&a.name));
    plan.free.retain(|free| !is_old(&free.name));
    for (a, x) in finer.amplitudes.iter().zip(curve.places(number, ends)) {
        let (full, least) = (chosen.full_name(&a.name), if a.positive { 0.0 } else { ANY_SIGN });
        let free =
            amplitude(&full, interpolated(&known, x), Some(least), &chosen.place, &chosen.prefix);
        plan.free.push(Free { acts_on: None, ..free });
    }
    let mut effects = hypothesis.effects.clone();
    effects[k] = chosen;
    let fit = &mut |p: &mut Problem<'_>| {
        let start = p.start();
        let on_step = &mut |_, _| search.on_step();
        let short = local_search(p, &start, &policy.short_fit, on_step)?;
        refined(p, &policy.fit, &short.x, &policy.fit.quick, on_step)
    };
    let mut fitted = Hypothesis::fitted(study, effects, plan, fit).ok()?;
    search.note(&format!(
        "{number} knots for {}: {:.4}, validation {:.4}",
        fitted.effects[k].name,
        fitted.chi2_train(),
        fitted.chi2_validation()
    ));
    fitted.is_complete_fit = true;
    (fitted.total_criterion() < hypothesis.total_criterion() - policy.evidence).then_some(fitted)
}
