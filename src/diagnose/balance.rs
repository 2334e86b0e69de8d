//! Balances that do not close: the inflow, free over time, that each balance of forces or flows would need to
//! explain the recordings.
//!
//! Every connection set is such a balance. An inflow is attached to it whose values over time form a curve
//! through many knots; the derivatives of a run by the knots at zero determine the inflow that brings the
//! signals closest to the measurements: an estimation of unknown inputs (P. K. Kitanidis, *Unbiased
//! minimum-variance linear state estimation*, Automatica 23, 1987), separately for each recording. Since
//! deconvolution is ill-posed, the inflow is damped as much as the residual allows (A. N. Tikhonov; V. A.
//! Morozov's discrepancy principle, *Methods for Solving Incorrectly Posed Problems*, 1984).

use std::sync::Arc;

use crate::base::diag::Problems;
use crate::calibrate::data::Split;
use crate::calibrate::parallel;
use crate::calibrate::problem::Problem;
use crate::numeric::least_squares::NormalEquations;
use crate::numeric::linear::DenseLu;

use super::catalogue::Effect;
use super::hypothesis::{Hypothesis, amplitude, attached};
use super::model_source::Attached;
use super::place::Place;
use super::study::Study;

/// Dampings to try, strongest first, relative to the mean square of the columns.
const DAMPINGS: [f64; 9] = [1e2, 1e1, 1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
/// The strongest damping is taken that keeps this share of the gain of the weakest.
const KEPT_GAIN: f64 = 0.9;
/// Share of the strongest column's mean square below which a knot has no influence; the inflow is zero there.
const INFLUENCE: f64 = 1e-3;
/// Weight of the magnitude of an inflow relative to its curvature.
const MAGNITUDE_WEIGHT: f64 = 0.03;
/// Intervals into which the range of a variable is divided to measure the scatter of an inflow.
const CLASSES: usize = 40;

/// A balance and the inflow that it would need.
#[derive(Clone, Debug)]
pub struct Balance {
    /// The component after which it is named.
    pub at: String,
    /// The class of the inflow.
    pub class: String,
    /// Unit of the inflow.
    pub unit: String,
    /// Share of the excess over the noise that the inflow would explain, to first order.
    pub explained: f64,
    /// The inflow in each training recording.
    pub profiles: Vec<Profile>,
    /// The variable, by its position in [`Profile::over`], on which the inflow depends most clearly.
    pub ordered_by: Option<usize>,
}

/// An inflow over the time of one recording.
#[derive(Clone, Debug)]
pub struct Profile {
    /// The recording.
    pub recording: String,
    /// Instants, s.
    pub time: Arc<[f64]>,
    /// The inflow at these instants.
    pub inflow: Vec<f64>,
    /// Variables over which it is shown: name, unit, values.
    pub over: Vec<(String, String, Vec<f64>)>,
}

/// All balances of a model, the one that explains most first.
pub fn balances(study: &Study, unknowns: &[Effect], hypothesis: &Hypothesis) -> Vec<Balance> {
    let mut found = Vec::new();
    for unknown in unknowns {
        for place in study.places(unknown, &study.plan) {
            found.extend(balance(study, unknown, place, hypothesis));
        }
    }
    found.sort_by(|a, b| b.explained.total_cmp(&a.explained));
    found
}

/// The force or flow that the first effect of a hypothesis contributes, recording by recording, for
/// comparison with the inflows of balances. Empty if it contributes none that the unknowns ask for.
pub fn contributions(study: &Study, unknowns: &[Effect], hypothesis: &Hypothesis) -> Vec<Profile> {
    contribution(study, unknowns, hypothesis).unwrap_or_default()
}

fn contribution(
    study: &Study,
    unknowns: &[Effect],
    hypothesis: &Hypothesis,
) -> Option<Vec<Profile>> {
    let chosen = hypothesis.effects.first()?;
    let effect = &study.effects[chosen.effect];
    let has = |name: &str| effect.units.iter().any(|(own, _)| own == name);
    let is_input = |name: &str| effect.binds.iter().any(|(input, _)| input == name);
    let contributed = |u: &&Effect| u.inflow.as_deref().is_some_and(|n| has(n) && !is_input(n));
    let unknown = unknowns.iter().find(contributed)?;
    let over: Vec<&str> = unknown.over.iter().map(String::as_str).filter(|n| has(n)).collect();
    let names = over.iter().copied().chain(unknown.inflow.as_deref());
    let names: Vec<String> = names.map(|n| chosen.full_name(n)).collect();
    let (plan, attached) = (&hypothesis.plan, attached(study, &hypothesis.effects));
    let (session, program) = study.compile(plan, &attached, &names).ok()?;
    let mut problems = Problems::new();
    let problem = Problem::new(&program, &session.sources, plan, &study.data, &mut problems)?;
    let x = problem.start();
    let mut profiles = Vec::new();
    for recording in problem.recordings(Split::Train) {
        let mut values = problem.others(recording, &x, &names).ok()?;
        let inflow = values.pop().filter(|_| values.len() == over.len())?;
        let over = over.iter().zip(values).map(|(n, v)| ((*n).to_owned(), String::new(), v));
        let (recording, time) = (recording.name.clone(), recording.time.clone());
        profiles.push(Profile { recording, time, inflow, over: over.collect() });
    }
    Some(profiles)
}

fn balance(
    study: &Study,
    unknown: &Effect,
    place: Place,
    hypothesis: &Hypothesis,
) -> Option<Balance> {
    const NAME: &str = "unknown";
    let mut all = attached(study, &hypothesis.effects);
    let mut plan = hypothesis.plan.clone();
    let free = plan.free.len();
    for a in &unknown.amplitudes {
        plan.free.push(amplitude(&format!("{NAME}.{}", a.name), 0.0, None, &place, NAME));
    }
    let ends =
        study.data.of(Split::Train).filter_map(|r| Some((*r.time.first()?, *r.time.last()?)));
    let (first, last) =
        ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), (t, u)| (a.min(t), b.max(u)));
    let values = vec![("t_lo".to_owned(), first), ("t_hi".to_owned(), last)];
    all.push(Attached::new(unknown, &place, NAME.to_owned(), values));
    let over: Vec<(String, String)> = unknown
        .over
        .iter()
        .filter_map(|n| unknown.units.iter().find(|(own, _)| own == n).cloned())
        .collect();
    let recorded: Vec<String> = over.iter().map(|(n, _)| format!("{NAME}.{n}")).collect();
    let (session, program) = study.compile(&plan, &all, &recorded).ok()?;
    let mut problems = Problems::new();
    let problem = Problem::new(&program, &session.sources, &plan, &study.data, &mut problems)?;
    let x = problem.start();
    let scales: Vec<f64> = problem.parameters[free..].iter().map(|p| p.scale.slope(0.0)).collect();
    let recordings = problem.recordings(Split::Train);
    let of_recording = |i: usize| {
        let recording = recordings[i];
        let normal = problem.normal_of(recording, &x).ok()?;
        let residuals: usize = recording.signals.iter().flatten().filter(|v| !v.is_nan()).count();
        let excess = (normal.cost - residuals as f64).max(0.0);
        let (knots, gain) = damped(&normal, free)?;
        let knots: Vec<f64> = knots.iter().zip(&scales).map(|(k, s)| k * s).collect();
        let place = |t: f64| (t - first) / (last - first) * (knots.len() - 1) as f64;
        let inflow = recording.time.iter().map(|t| between(&knots, place(*t))).collect();
        let values = problem.others(recording, &x, &recorded).ok()?;
        let over = over.iter().zip(values).map(|((n, u), v)| (n.clone(), u.clone(), v)).collect();
        let (recording, time) = (recording.name.clone(), recording.time.clone());
        Some((Profile { recording, time, inflow, over }, gain.min(excess), excess))
    };
    let (mut gain, mut excess) = (0.0, 0.0);
    let mut profiles = Vec::new();
    for one in parallel::map(problem.jobs, recordings.len(), of_recording) {
        let (profile, own, all) = one?;
        profiles.push(profile);
        gain += own;
        excess += all;
    }
    let unit = unknown
        .amplitudes
        .first()
        .and_then(|a| unknown.units.iter().find(|(n, _)| *n == a.name).map(|(_, u)| u.clone()));
    let ordered_by = (0..over.len()).map(|k| (k, scatter(&profiles, k)));
    Some(Balance {
        at: place.at.join(", "),
        class: unknown.class.clone(),
        unit: unit.unwrap_or_default(),
        explained: gain / excess.max(f64::MIN_POSITIVE),
        ordered_by: ordered_by.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k),
        profiles,
    })
}

/// The knots, the columns from `free` on, that reduce the residuals, and their gain.
fn damped(normal: &NormalEquations, free: usize) -> Option<(Vec<f64>, f64)> {
    let (n, m) = (normal.n, normal.n - free);
    let entry = |i: usize, j: usize| normal.gram[(free + i) + n * (free + j)];
    let mean = (0..m).map(|i| entry(i, i)).sum::<f64>() / m.max(1) as f64;
    if mean <= 0.0 {
        return Some((vec![0.0; m], 0.0));
    }
    let strongest = (0..m).map(|i| entry(i, i)).fold(0.0, f64::max);
    let idle: Vec<bool> = (0..m).map(|i| entry(i, i) < INFLUENCE * strongest).collect();
    let solved = |damping: f64| {
        let mut lu = DenseLu::new(m);
        let mut matrix = vec![0.0; m * m];
        for j in 0..m {
            for i in 0..m {
                let penalty = bending(m, i, j) + if i == j { MAGNITUDE_WEIGHT } else { 0.0 };
                matrix[i + m * j] = if idle[i] || idle[j] {
                    if i == j { mean } else { 0.0 }
                } else {
                    entry(i, j) + damping * mean * penalty
                };
            }
        }
        lu.factor(&matrix).ok()?;
        let right = |i: usize| if idle[i] { 0.0 } else { -normal.gradient[free + i] };
        let mut knots: Vec<f64> = (0..m).map(right).collect();
        lu.solve_in_place(&mut knots);
        let mut gain = 0.0;
        for j in 0..m {
            let product: f64 = (0..m).map(|i| entry(i, j) * knots[i]).sum();
            gain -= knots[j] * (2.0 * normal.gradient[free + j] + product);
        }
        Some((knots, gain))
    };
    let all: Vec<(Vec<f64>, f64)> = DAMPINGS.iter().filter_map(|d| solved(*d)).collect();
    let most = all.last()?.1;
    all.into_iter().find(|(_, gain)| *gain >= KEPT_GAIN * most)
}

/// Entry of the square of second differences of `m` knots.
fn bending(m: usize, i: usize, j: usize) -> f64 {
    let weight = |row: usize, k: usize| match k.abs_diff(row) {
        0 => -2.0,
        1 => 1.0,
        _ => 0.0,
    };
    (1..m.saturating_sub(1)).map(|row| weight(row, i) * weight(row, j)).sum()
}

/// The value of the curve at a position between the knots.
fn between(knots: &[f64], place: f64) -> f64 {
    let place = place.clamp(0.0, (knots.len() - 1) as f64);
    let k = (place as usize).min(knots.len().saturating_sub(2));
    let part = place - k as f64;
    knots[k] * (1.0 - part) + knots.get(k + 1).copied().unwrap_or(knots[k]) * part
}

/// Share of the inflow's mean square that is left within classes of a variable: small if the variable alone
/// determines the inflow.
fn scatter(profiles: &[Profile], over: usize) -> f64 {
    let pairs = || profiles.iter().flat_map(|c| c.over[over].2.iter().zip(&c.inflow));
    let range =
        pairs().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), (x, _)| (a.min(*x), b.max(*x)));
    let class = |x: f64| {
        let part = (x - range.0) / (range.1 - range.0).max(f64::MIN_POSITIVE);
        ((part * CLASSES as f64) as usize).min(CLASSES - 1)
    };
    let mut sums = vec![(0.0, 0.0, 0.0); CLASSES];
    for (x, y) in pairs() {
        let sum = &mut sums[class(*x)];
        *sum = (sum.0 + 1.0, sum.1 + y, sum.2 + y * y);
    }
    let within: f64 = sums.iter().filter(|s| s.0 > 0.0).map(|s| s.2 - s.1 * s.1 / s.0).sum();
    within / pairs().map(|(_, y)| y * y).sum::<f64>().max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_position_orders_a_force_that_depends_on_it() {
        let time: Vec<f64> = (0..400).map(|k| 0.01 * k as f64).collect();
        let position: Vec<f64> = time.iter().map(|t| t.sin()).collect();
        let velocity: Vec<f64> = time.iter().map(|t| t.cos()).collect();
        let inflow = position.iter().map(|s| 3.0 * s * s).collect();
        let over = vec![
            ("s".to_owned(), "m".to_owned(), position),
            ("v".to_owned(), "m/s".to_owned(), velocity.iter().map(|v| v + 0.3).collect()),
        ];
        let profile = Profile { recording: "1".to_owned(), time: time.into(), inflow, over };
        assert!(scatter(std::slice::from_ref(&profile), 0) < 0.01);
        assert!((between(&[1.0, 3.0], 0.25) - 1.5).abs() < 1e-15);
    }

    /// Two columns of which one explains everything.
    #[test]
    fn the_damping_is_as_strong_as_the_residual_allows() {
        let mut normal = NormalEquations::new(3);
        for k in 0..50 {
            let t = 0.1 * k as f64;
            normal.add(-2.0 * t.sin(), &[0.0, t.sin(), t.cos()]);
        }
        let (knots, gain) = damped(&normal, 1).unwrap();
        assert!((knots[0] - 2.0).abs() < 0.5 && knots[1].abs() < 0.2, "{knots:?}");
        assert!(gain >= KEPT_GAIN * normal.cost * 0.999);
    }
}
