//! New knots for a free curve: those of the score test lie in the range that its variable covers without the
//! effect, and a large effect changes that range.

use super::catalogue::{Amplitude, Effect};
use super::formula::FreeCurve;
use super::hypothesis::{ChosenEffect, Hypothesis};
use super::search::Search;
use super::shape_parameters::{ranges, shapes_at};

/// Share of the range by which its ends must move for new knots.
const MOVED: f64 = 0.05;

/// The hypothesis with the knots of its last effect, a free curve, in the range that its variable covers now; the
/// values there start on the old curve. `None` if the knots may stay where they are, or if that range is not known. Not fitted
/// again.
pub fn regridded(search: &Search<'_>, hypothesis: &Hypothesis) -> Option<Hypothesis> {
    let study = search.study;
    let chosen = hypothesis.effects.last()?;
    let effect = &study.effects[chosen.effect];
    let curve = effect.curve.as_ref()?;
    let shape = shape_of_moved(search, hypothesis, chosen, curve)?;
    let new = ends(&shape, curve)?;
    let n = effect.amplitudes.len();
    let known = fitted_points(hypothesis, chosen, effect, curve)?;
    let anchor = if curve.is_anchored { interpolated(&known, new.0) } else { 0.0 };
    let mut moved = hypothesis.clone();
    for (a, x) in effect.amplitudes.iter().zip(curve.places(n, new)) {
        let full = chosen.full_name(&a.name);
        let free = moved.plan.free.iter_mut().find(|f| f.name == full)?;
        free.start = Some(interpolated(&known, x) - anchor);
    }
    let last: &mut ChosenEffect = moved.effects.last_mut()?;
    for (name, value) in &mut last.fixed {
        if let Some((_, moved)) = shape.iter().find(|(n, _)| n == name) {
            *value = *moved;
        }
    }
    Some(moved)
}

/// The shape parameters of a free curve for the range that its variable covers now; `None` if it hardly differs from that of
/// the knots, or if it is not known.
fn shape_of_moved(
    search: &Search<'_>,
    hypothesis: &Hypothesis,
    chosen: &ChosenEffect,
    curve: &FreeCurve,
) -> Option<Vec<(String, f64)>> {
    let study = search.study;
    let found = ranges(study, hypothesis, &[(chosen.effect, chosen.place.clone())]);
    if found.is_empty() {
        return None;
    }
    let shapes = shapes_at(study, &found, chosen.effect, &chosen.place)?;
    let shape = shapes.into_iter().next()?;
    let (old, new) = (ends(&chosen.fixed, curve)?, ends(&shape, curve)?);
    let limit = MOVED * (new.1 - new.0).abs();
    let stays = (old.0 - new.0).abs() <= limit && (old.1 - new.1).abs() <= limit;
    (!stays && new.1 > new.0).then_some(shape)
}

/// The range that the variable of a free curve covers now, if it differs from that of the knots.
pub(super) fn moved_range(
    search: &Search<'_>,
    hypothesis: &Hypothesis,
    chosen: &ChosenEffect,
    curve: &FreeCurve,
) -> Option<(f64, f64)> {
    ends(&shape_of_moved(search, hypothesis, chosen, curve)?, curve)
}

/// The first and the last knot of a curve with these shape parameters.
pub(super) fn ends(values: &[(String, f64)], curve: &FreeCurve) -> Option<(f64, f64)> {
    let of = |name: &String| values.iter().find(|(n, _)| n == name).map(|(_, v)| *v);
    Some((curve.from.as_ref().map_or(Some(0.0), of)?, of(&curve.to)?))
}

/// The points of a fitted curve.
pub(super) fn fitted_points(
    hypothesis: &Hypothesis,
    chosen: &ChosenEffect,
    effect: &Effect,
    curve: &FreeCurve,
) -> Option<Vec<(f64, f64)>> {
    let ends = ends(&chosen.fixed, curve)?;
    let value = |a: &Amplitude| Some(hypothesis.estimate(&chosen.full_name(&a.name))?.0);
    let values: Option<Vec<f64>> = effect.amplitudes.iter().map(value).collect();
    let places = curve.places(effect.amplitudes.len(), ends);
    Some(on_curve(curve.fixed_point(ends.0), &places, &values?))
}

/// The points of a curve.
fn on_curve(fixed: Option<(f64, f64)>, places: &[f64], values: &[f64]) -> Vec<(f64, f64)> {
    fixed.into_iter().chain(places.iter().copied().zip(values.iter().copied())).collect()
}

/// A value between points, or that of the nearest end.
pub(super) fn interpolated(points: &[(f64, f64)], x: f64) -> f64 {
    let k = points.partition_point(|(p, _)| *p < x);
    match (k.checked_sub(1).map(|j| points[j]), points.get(k).copied()) {
        (Some((a, y)), Some((b, z))) => y + (z - y) * (x - a) / (b - a),
        (Some((_, y)), None) | (None, Some((_, y))) => y,
        (None, None) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn new_values_lie_on_the_old_curve() {
        let points = on_curve(Some((0.0, 0.0)), &[1.0, 2.0], &[10.0, 40.0]);
        let values = [0.5, 1.5, 2.0, 9.0].map(|x| interpolated(&points, x));
        assert_eq!(values, [5.0, 25.0, 40.0, 40.0]);
    }
}
