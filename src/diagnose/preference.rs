//! Which of several fitted explanations is preferred.

use super::case::Case;
use super::level::Level;

/// An effect with so many amplitudes is a free curve.
pub const CURVE: usize = 4;
/// A law that explains this share of what a free curve does is taken for it.
const NEARLY: f64 = 0.95;
/// But not, if it leaves so many times what the curve leaves.
const FAR: f64 = 5.0;
/// If the curve leaves nothing to explain, the law must leave less than this too.
const NEARLY_COMPLETE: f64 = 0.1;
/// Decrease of the Bayesian information criterion that counts, well above what the best of hundreds of
/// places reaches by chance.
pub const EVIDENCE: f64 = 30.0;
/// Reduced sum of squares up to which nothing is left to explain.
pub const COMPLETE: f64 = 1.03;
/// The same of recordings that were never fitted.
pub const RESOLVED: f64 = 1.1;

/// Best first. Of what is not known before a free curve explains as much as the law that it contains, and
/// what noise and drift leave besides: it comes first only where no law explains nearly as much.
pub fn in_order(case: &Case<'_>, from: &Level, levels: &mut [Level], by: impl Fn(&Level) -> f64) {
    levels.sort_by(|a, b| by(a).total_cmp(&by(b)));
    // A sensor is blamed only if nothing that it measures explains as much: what is in proportion to a
    // pressure is the scale of the sensor as well.
    let of_sensor = |l: &Level| l.chosen.last().is_some_and(|c| c.place.signal.is_some());
    if let Some(sensor) = levels.first().filter(|l| of_sensor(l)) {
        let as_good = by(sensor) + EVIDENCE;
        if let Some(k) = levels.iter().position(|l| !of_sensor(l) && by(l) < as_good) {
            levels[..=k].rotate_right(1);
        }
    }
    let Some(curve) = levels.first().filter(|l| is_curve(case, l)) else { return };
    let explained = |l: &Level| from.train.total() - l.train.total();
    let wanted = NEARLY * explained(curve);
    let complete = curve.chi2_train() < COMPLETE;
    let far = FAR * curve.train.total();
    let nearly = |l: &Level| {
        let as_good = explained(l) > wanted && l.train.total() < far;
        as_good && (!complete || l.chi2_train() < 1.0 + NEARLY_COMPLETE)
    };
    let is_law = |l: &Level| !is_curve(case, l) && !of_sensor(l);
    if let Some(k) = levels.iter().position(|l| is_law(l) && nearly(l)) {
        levels[..=k].rotate_right(1);
    }
}

/// True if what was found last is a free curve.
pub fn is_curve(case: &Case<'_>, level: &Level) -> bool {
    level.chosen.last().is_some_and(|c| case.effects[c.effect].amplitudes.len() >= CURVE)
}
