//! The fit: Levenberg-Marquardt from the plan's start, with restarts where it stalls at a local minimum.
//!
//! The sum of squares of a machine with dry friction is discontinuous: a body that comes to rest for a
//! moment continues differently from one that only slows down. A recording on the wrong side of such a
//! jump has no gradient towards the right side, and holds the parameters back. So the recordings that fit
//! worst are trimmed for a while (least trimmed squares: P. J. Rousseeuw, K. Van Driessen, *Computing LTS
//! regression for large data sets*, Data Mining and Knowledge Discovery 12, 2006): the others lead the
//! parameters to where the trimmed ones fit as well.
//! A fit that creeps along a jump crosses it in the same way: the recordings that jump are trimmed.

use crate::numeric::halton::Halton;
use crate::numeric::least_squares::{Minimum, NormalEquations, Residuals, Stopping, minimize};

use super::data::Split;
use super::policy::FitPolicy;
use super::problem::Problem;

/// A fitted set of parameters.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The parameters, in coordinates of the search.
    pub x: Vec<f64>,
    /// The normal equations there.
    pub normal: NormalEquations,
    /// Number of steps.
    pub iterations: u32,
    /// The fit ended because nothing was left to gain.
    pub converged: bool,
    /// If the fit ended where some recordings jump to another trajectory: a point beyond the jump.
    pub beyond: Option<Vec<f64>>,
}

/// Called after each step with the number of steps of this search and the sum of squares; `false` ends the
/// search.
pub type OnStep<'a> = dyn FnMut(u32, f64) -> bool + 'a;

/// Fits from the plan's start, and from other points if that fit is not adequate. `None` if the model cannot
/// be simulated at any of them.
pub fn fit(problem: &mut Problem<'_>, policy: &FitPolicy, on_step: &mut OnStep<'_>) -> Option<Fit> {
    let start = problem.start();
    let from_start = fit_from(problem, policy, &start, on_step);
    if problem.stopped || from_start.as_ref().is_some_and(|f| reduced(problem, f) < policy.adequate)
    {
        return from_start;
    }
    let bounds = problem.bounds();
    let mut halton = Halton::new(start.len());
    let mut places: Vec<(f64, Vec<f64>)> = Vec::new();
    for _ in 0..policy.restart_points {
        let around = halton.next_point().into_iter().zip(&start).zip(&bounds);
        let point: Vec<f64> = around
            .map(|((u, s), b)| (s + policy.restart_spread * (2.0 * u - 1.0)).max(b.0).min(b.1))
            .collect();
        if let Ok(sums) = problem.sums(Split::Train, &point) {
            places.push((sums.total(), point));
        }
    }
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best = from_start;
    for (_, place) in places.into_iter().take(policy.restarts) {
        if problem.stopped {
            break;
        }
        let Some(found) = fit_from(problem, policy, &place, on_step) else { continue };
        if best.as_ref().is_none_or(|b| found.normal.cost < b.normal.cost) {
            best = Some(found);
        }
        if best.as_ref().is_some_and(|b| reduced(problem, b) < policy.adequate) {
            break;
        }
    }
    best
}

/// Fits from the plan's start with the quick stopping rule: for models that may lack an effect, whose best
/// fit is poor in any case.
pub fn quick_fit(
    problem: &mut Problem<'_>,
    policy: &FitPolicy,
    on_step: &mut OnStep<'_>,
) -> Option<Fit> {
    let start = problem.start();
    refined(problem, policy, &start, &policy.quick, on_step)
}

/// Searches from one point, and continues from local minima that it can escape.
pub fn refined(
    problem: &mut Problem<'_>,
    policy: &FitPolicy,
    start: &[f64],
    stopping: &Stopping,
    on_step: &mut OnStep<'_>,
) -> Option<Fit> {
    let found = search(problem, start, stopping, on_step)?;
    Some(refine(problem, policy, found, on_step))
}

/// Fits from one point, and trims the recordings that fit worst for as long as that helps.
pub fn fit_from(
    problem: &mut Problem<'_>,
    policy: &FitPolicy,
    start: &[f64],
    on_step: &mut OnStep<'_>,
) -> Option<Fit> {
    let mut best = search(problem, start, &policy.full, on_step)?;
    for _ in 0..policy.trimming_rounds {
        if reduced(problem, &best) < policy.adequate {
            break;
        }
        let crossed = cross_jump(problem, policy, &best, on_step);
        match crossed.or_else(|| trim(problem, policy, &best, on_step)) {
            Some(found) => best = found,
            None => break,
        }
    }
    Some(best)
}

/// Continues from a local minimum, for models that may lack an effect: recordings are trimmed only if most of
/// the others fit.
pub fn refine(
    problem: &mut Problem<'_>,
    policy: &FitPolicy,
    mut best: Fit,
    on_step: &mut OnStep<'_>,
) -> Fit {
    for _ in 0..policy.trimming_rounds {
        if reduced(problem, &best) < policy.adequate || problem.stopped {
            break;
        }
        let crossed = cross_jump(problem, policy, &best, on_step);
        let found = crossed.or_else(|| {
            let hindered = is_hindered(problem, policy, &best);
            hindered.then(|| trim(problem, policy, &best, on_step)).flatten()
        });
        match found {
            Some(found) => best = found,
            None => break,
        }
    }
    best
}

/// True if a few recordings fit much worse than the others, or most fit well: the rest may lie on the wrong
/// side of a jump.
fn is_hindered(problem: &Problem<'_>, policy: &FitPolicy, fit: &Fit) -> bool {
    let Ok(sums) = problem.sums(Split::Train, &fit.x) else { return false };
    let mut each = sums.by_recording();
    each.sort_by(f64::total_cmp);
    let (Some(median), Some(worst)) = (each.get(each.len() / 2), each.last()) else { return false };
    *median < policy.trimmed_adequate || *worst > policy.hindering_factor * median
}

/// A better fit beyond the jump at which a search ended: the recordings that jump are trimmed until the
/// others have led past it.
fn cross_jump(
    problem: &mut Problem<'_>,
    policy: &FitPolicy,
    best: &Fit,
    on_step: &mut OnStep<'_>,
) -> Option<Fit> {
    let mut trimmed = jumping(problem, policy, best)?;
    let mut others = None;
    for _ in 0..policy.trimming_rounds {
        problem.trimmed.clone_from(&trimmed);
        let found = search(problem, &best.x, &policy.trimmed, on_step);
        let more = found.as_ref().and_then(|f| jumping(problem, policy, f)).unwrap_or_default();
        problem.trimmed = Vec::new();
        others = found.or(others);
        let known = trimmed.len();
        trimmed.extend(more.into_iter().filter(|i| !trimmed.contains(i)).collect::<Vec<_>>());
        let too_many = trimmed.len() + 2 > problem.recordings(Split::Train).len();
        if trimmed.len() == known || too_many {
            break;
        }
    }
    let found = search(problem, &others?.x, &policy.full, on_step)?;
    (found.normal.cost < (1.0 - policy.improvement) * best.normal.cost).then_some(found)
}

/// The recordings that take another trajectory beyond the point at which a search ended.
fn jumping(problem: &Problem<'_>, policy: &FitPolicy, fit: &Fit) -> Option<Vec<usize>> {
    let squares = |x: &[f64]| {
        let sums = problem.sums(Split::Train, x).ok()?;
        Some(sums.squares.iter().map(|s| s.iter().sum()).collect::<Vec<f64>>())
    };
    let (here, there) = (squares(&fit.x)?, squares(fit.beyond.as_ref()?)?);
    let total: f64 = here.iter().sum();
    let share = policy.jump_share * total / here.len() as f64;
    let jumps = |i: &usize| !problem.trimmed.contains(i) && there[*i] - here[*i] > share;
    let all: Vec<usize> = (0..here.len()).filter(jumps).collect();
    (!all.is_empty()).then_some(all)
}

/// A better fit to all recordings by way of a fit without the worst ones, if the others alone fit well.
fn trim(
    problem: &mut Problem<'_>,
    policy: &FitPolicy,
    best: &Fit,
    on_step: &mut OnStep<'_>,
) -> Option<Fit> {
    let sums = problem.sums(Split::Train, &best.x).ok()?;
    let by_recording = sums.by_recording();
    let squares: Vec<f64> = sums.squares.iter().map(|s| s.iter().sum()).collect();
    for trimmed in suspects(policy, &by_recording) {
        let kept = by_recording.len() - trimmed.len();
        let share = kept as f64 / by_recording.len() as f64;
        let count = problem.count(Split::Train) as f64 * share;
        problem.trimmed.clone_from(&trimmed);
        let others = search(problem, &best.x, &policy.trimmed, on_step);
        problem.trimmed = Vec::new();
        let led = |o: &Fit| {
            let kept: f64 =
                (0..squares.len()).filter(|i| !trimmed.contains(i)).map(|i| squares[i]).sum();
            o.normal.cost / count < policy.trimmed_adequate
                || o.normal.cost < policy.trimmed_decrease * kept
        };
        let Some(others) = others.filter(led) else { continue };
        let Some(found) = search(problem, &others.x, &policy.full, on_step) else { continue };
        if found.normal.cost < (1.0 - policy.improvement) * best.normal.cost {
            return Some(found);
        }
    }
    None
}

/// Sets of recordings to trim, most promising first.
fn suspects(policy: &FitPolicy, by_recording: &[f64]) -> Vec<Vec<usize>> {
    let n = by_recording.len();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|a, b| by_recording[*b].total_cmp(&by_recording[*a]));
    let typical = by_recording[order[n / 2]];
    let limit = (policy.outlier_factor * typical).max(policy.adequate);
    let outlying = order.iter().filter(|i| by_recording[**i] > limit).count();
    let mut sets: Vec<Vec<usize>> = Vec::new();
    for count in [1, 2, n / 2, outlying] {
        let set: Vec<usize> = order.iter().copied().take(count.min(n.saturating_sub(2))).collect();
        if outlying > 0 && !set.is_empty() && !sets.contains(&set) {
            sets.push(set);
        }
    }
    sets
}

/// One search from one point.
pub fn search(
    problem: &mut Problem<'_>,
    start: &[f64],
    stopping: &Stopping,
    on_step: &mut OnStep<'_>,
) -> Option<Fit> {
    let bounds = problem.bounds();
    let mut observed = Observed { problem, on_step };
    let Minimum { x, normal, iterations, converged, beyond } =
        minimize(&mut observed, start, &bounds, stopping)?;
    Some(Fit { x, normal, iterations, converged, beyond })
}

fn reduced(problem: &Problem<'_>, fit: &Fit) -> f64 {
    let count = problem.count(Split::Train).saturating_sub(fit.x.len()).max(1);
    fit.normal.cost / count as f64
}

struct Observed<'a, 'p, 's> {
    problem: &'a mut Problem<'p>,
    on_step: &'a mut OnStep<'s>,
}

impl Residuals for Observed<'_, '_, '_> {
    fn normal(&mut self, x: &[f64]) -> Option<NormalEquations> {
        Residuals::normal(self.problem, x)
    }
    fn cost(&mut self, x: &[f64]) -> Option<f64> {
        Residuals::cost(self.problem, x)
    }
    fn accepts_step(&mut self, iteration: u32, _x: &[f64], cost: f64) -> bool {
        self.problem.stopped |= !(self.on_step)(iteration, cost);
        !self.problem.stopped
    }
}
