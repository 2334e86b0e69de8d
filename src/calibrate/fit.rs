//! The search for the parameters: a look around first, then Levenberg and Marquardt's method from the
//! best places.

use crate::math::numeric::least_squares::{Minimum, Normal, Residuals, Stopping, minimise};
use crate::math::numeric::sequence::Halton;

use super::data::Split;
use super::problem::Problem;

/// Places that are looked at before the search.
const PLACES: usize = 12;
/// Spread of these places around the start, in units of the search: factors of up to two.
const SPREAD: f64 = 0.7;
/// Reduced sums of squares closer than this are one minimum.
const SAME: f64 = 1e-3;

/// When the search stops.
pub const STOPPING: Stopping = Stopping { decrease: 1e-7, step: 1e-7, iterations: 60, reach: 1.0 };

/// What was found.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The parameters, as the search sees them.
    pub x: Vec<f64>,
    /// The normal equations there.
    pub normal: Normal,
    /// Steps in all.
    pub iterations: u32,
    /// Ended because nothing was left to gain.
    pub converged: bool,
}

/// Fits from the start of the plan, and from elsewhere if other places look better. `None` if the model
/// can not be run anywhere.
pub fn fit(problem: &mut Problem<'_>, heed: &mut dyn FnMut(u32, f64) -> bool) -> Option<Fit> {
    let (start, bounds) = (problem.start(), problem.bounds());
    let from_start = search(problem, &start, &bounds, heed);
    let count = problem.sums(Split::Train, &start).map_or(1, |s| s.count()) as f64;
    let good = |f: &Fit| f.normal.cost / count < 1.5;
    if from_start.as_ref().is_some_and(good) {
        return from_start;
    }
    let mut places = Vec::new();
    let mut halton = Halton::new(start.len());
    for _ in 0..PLACES {
        let point: Vec<f64> = halton
            .next_point()
            .iter()
            .zip(&start)
            .zip(&bounds)
            .map(|((u, s), b)| (s + SPREAD * (2.0 * u - 1.0)).max(b.0).min(b.1))
            .collect();
        if let Ok(sums) = problem.sums(Split::Train, &point) {
            places.push((sums.total(), point));
        }
    }
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best = from_start;
    for (_, place) in places.iter().take(2) {
        let Some(found) = search(problem, place, &bounds, heed) else { continue };
        let better = best.as_ref().is_none_or(|b| found.normal.cost < b.normal.cost);
        let same = best
            .as_ref()
            .is_some_and(|b| (found.normal.cost - b.normal.cost).abs() < SAME * b.normal.cost);
        if better {
            best = Some(found);
        }
        if same {
            break;
        }
    }
    best
}

/// One search from one place.
pub fn search(
    problem: &mut Problem<'_>,
    start: &[f64],
    bounds: &[(f64, f64)],
    heed: &mut dyn FnMut(u32, f64) -> bool,
) -> Option<Fit> {
    let mut heeded = Heeded { problem, heed };
    let Minimum { x, normal, iterations, converged } =
        minimise(&mut heeded, start, bounds, &STOPPING)?;
    Some(Fit { x, normal, iterations, converged })
}

struct Heeded<'a, 'p> {
    problem: &'a mut Problem<'p>,
    heed: &'a mut dyn FnMut(u32, f64) -> bool,
}

impl Residuals for Heeded<'_, '_> {
    fn normal(&mut self, x: &[f64]) -> Option<Normal> {
        Residuals::normal(self.problem, x)
    }
    fn cost(&mut self, x: &[f64]) -> Option<f64> {
        Residuals::cost(self.problem, x)
    }
    fn goes_on(&mut self, iteration: u32, _x: &[f64], cost: f64) -> bool {
        (self.heed)(iteration, cost)
    }
}
