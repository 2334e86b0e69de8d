//! The search for the parameters: Levenberg and Marquardt's method, and ways out of where it gets caught.
//!
//! The sum of squares of a machine with dry friction jumps: a body that comes to rest for a moment and
//! one that only slows down go on differently. A recording that stands on the wrong side of such a jump
//! feels no slope towards the right one, and pulls the others away. So the recordings that fit worst
//! are left out for a while (least trimmed squares: P. J. Rousseeuw, K. Van Driessen, *Computing LTS
//! regression for large data sets*, Data Mining and Knowledge Discovery 12, 2006): the others lead to
//! where it comes right by itself.
//! A search that creeps along such a jump is led past it in the same way: those that jump are left out.

use crate::numeric::halton::Halton;
use crate::numeric::least_squares::{Minimum, NormalEquations, Residuals, Stopping, minimize};

use super::data::Split;
use super::problem::Problem;

/// Places that are looked at if the start of the plan leads nowhere.
const PLACES: usize = 12;
/// Spread of these places around the start, in units of the search: factors of about two.
const SPREAD: f64 = 0.6;
/// Reduced sum of squares below which nothing is wrong with a fit.
const FINE: f64 = 1.05;
/// A recording that fits worse than the others by this factor may stand on the wrong side of a jump.
const OUTLYING: f64 = 1.3;
/// Rounds of leaving out.
const ROUNDS: usize = 4;
/// Reduced sum of squares of the others at which leaving out has shown the way.
const WELL: f64 = 1.5;
/// The same where these others fit that much better than with those that were left out.
const LED: f64 = 0.6;
/// Recordings that fit worse than the others by this factor keep a search of a model that may lack something
/// from better places.
const HINDERING: f64 = 2.5;
/// A recording jumps if its sum of squares rises by this share of the mean.
const JUMPING: f64 = 0.1;
/// A sum of squares must fall by this part to count as better.
const BETTER: f64 = 1e-3;

/// When the search stops.
pub const STOPPING: Stopping = Stopping { decrease: 1e-7, step: 1e-7, iterations: 60, reach: 1.0 };
/// The same where the best fit is bad in any case.
pub const QUICK: Stopping = Stopping { decrease: 1e-5, step: 1e-6, iterations: 25, reach: 1.0 };
/// The same while recordings are left out: the way is what counts.
const ON_THE_WAY: Stopping = Stopping { decrease: 1e-4, step: 1e-5, iterations: 15, reach: 1.0 };

/// What was found.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The parameters, as the search sees them.
    pub x: Vec<f64>,
    /// The normal equations there.
    pub normal: NormalEquations,
    /// Steps in all.
    pub iterations: u32,
    /// Ended because nothing was left to gain.
    pub converged: bool,
    /// Ended where some recordings jump to another course: a place beyond that.
    pub beyond: Option<Vec<f64>>,
}

/// Told after each step: steps so far and the sum of squares. False ends the search.
pub type Heed<'a> = dyn FnMut(u32, f64) -> bool + 'a;

/// Fits from the start of the plan, and from elsewhere if that leads nowhere. `None` if the model can not
/// be run anywhere.
pub fn fit(problem: &mut Problem<'_>, heed: &mut Heed<'_>) -> Option<Fit> {
    let start = problem.start();
    let from_start = fit_from(problem, &start, heed);
    if problem.stopped || from_start.as_ref().is_some_and(|f| reduced(problem, f) < FINE) {
        return from_start;
    }
    let bounds = problem.bounds();
    let mut halton = Halton::new(start.len());
    let mut places: Vec<(f64, Vec<f64>)> = Vec::new();
    for _ in 0..PLACES {
        let around = halton.next_point().into_iter().zip(&start).zip(&bounds);
        let point: Vec<f64> =
            around.map(|((u, s), b)| (s + SPREAD * (2.0 * u - 1.0)).max(b.0).min(b.1)).collect();
        if let Ok(sums) = problem.sums(Split::Train, &point) {
            places.push((sums.total(), point));
        }
    }
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best = from_start;
    for (_, place) in places.into_iter().take(2) {
        if problem.stopped {
            break;
        }
        let Some(found) = fit_from(problem, &place, heed) else { continue };
        if best.as_ref().is_none_or(|b| found.normal.cost < b.normal.cost) {
            best = Some(found);
        }
        if best.as_ref().is_some_and(|b| reduced(problem, b) < FINE) {
            break;
        }
    }
    best
}

/// Fits from the start of the plan, and leaves out what fits worst once: for models that may lack
/// something, of which the best fit is bad in any case.
pub fn quick_fit(problem: &mut Problem<'_>, heed: &mut Heed<'_>) -> Option<Fit> {
    let start = problem.start();
    refined(problem, &start, &QUICK, heed)
}

/// Searches from one place, and goes on where the search was caught.
pub fn refined(
    problem: &mut Problem<'_>,
    start: &[f64],
    stopping: &Stopping,
    heed: &mut Heed<'_>,
) -> Option<Fit> {
    let found = search(problem, start, stopping, heed)?;
    Some(refine(problem, found, heed))
}

/// Fits from one place, leaving out what fits worst as long as that helps.
pub fn fit_from(problem: &mut Problem<'_>, start: &[f64], heed: &mut Heed<'_>) -> Option<Fit> {
    let mut best = search(problem, start, &STOPPING, heed)?;
    for _ in 0..ROUNDS {
        if reduced(problem, &best) < FINE {
            break;
        }
        match cross(problem, &best, heed).or_else(|| leave_out(problem, &best, heed)) {
            Some(found) => best = found,
            None => break,
        }
    }
    Some(best)
}

/// Goes on where a search was caught, for models that may lack something: what fits worst is left out
/// only if most recordings fit.
pub fn refine(problem: &mut Problem<'_>, mut best: Fit, heed: &mut Heed<'_>) -> Fit {
    for _ in 0..ROUNDS {
        if reduced(problem, &best) < FINE || problem.stopped {
            break;
        }
        let crossed = cross(problem, &best, heed);
        let found = crossed.or_else(|| {
            is_hindered(problem, &best).then(|| leave_out(problem, &best, heed)).flatten()
        });
        match found {
            Some(found) => best = found,
            None => break,
        }
    }
    best
}

/// True if a few recordings fit much worse than the others, or most fit well: those may stand on the wrong
/// side of a jump.
fn is_hindered(problem: &Problem<'_>, fit: &Fit) -> bool {
    let Ok(sums) = problem.sums(Split::Train, &fit.x) else { return false };
    let mut each = sums.by_recording();
    each.sort_by(f64::total_cmp);
    let (Some(median), Some(worst)) = (each.get(each.len() / 2), each.last()) else { return false };
    *median < WELL || *worst > HINDERING * median
}

/// A better fit beyond the jump that caught a search: the recordings that jump are left out until the
/// others have led past it.
fn cross(problem: &mut Problem<'_>, best: &Fit, heed: &mut Heed<'_>) -> Option<Fit> {
    let mut left_out = jumping(problem, best)?;
    let mut others = None;
    for _ in 0..ROUNDS {
        problem.left_out.clone_from(&left_out);
        let found = search(problem, &best.x, &ON_THE_WAY, heed);
        let more = found.as_ref().and_then(|f| jumping(problem, f)).unwrap_or_default();
        problem.left_out = Vec::new();
        others = found.or(others);
        let known = left_out.len();
        left_out.extend(more.into_iter().filter(|i| !left_out.contains(i)).collect::<Vec<_>>());
        let too_many = left_out.len() + 2 > problem.recordings(Split::Train).len();
        if left_out.len() == known || too_many {
            break;
        }
    }
    let found = search(problem, &others?.x, &STOPPING, heed)?;
    (found.normal.cost < (1.0 - BETTER) * best.normal.cost).then_some(found)
}

/// The recordings that take another course beyond the place where a search ended.
fn jumping(problem: &Problem<'_>, fit: &Fit) -> Option<Vec<usize>> {
    let squares = |x: &[f64]| {
        let sums = problem.sums(Split::Train, x).ok()?;
        Some(sums.squares.iter().map(|s| s.iter().sum()).collect::<Vec<f64>>())
    };
    let (here, there) = (squares(&fit.x)?, squares(fit.beyond.as_ref()?)?);
    let total: f64 = here.iter().sum();
    let share = JUMPING * total / here.len() as f64;
    let jumps = |i: &usize| !problem.left_out.contains(i) && there[*i] - here[*i] > share;
    let all: Vec<usize> = (0..here.len()).filter(jumps).collect();
    (!all.is_empty()).then_some(all)
}

/// A better fit to all, by way of a fit to those that do not fit worst: if these alone fit well.
fn leave_out(problem: &mut Problem<'_>, best: &Fit, heed: &mut Heed<'_>) -> Option<Fit> {
    let sums = problem.sums(Split::Train, &best.x).ok()?;
    let by_recording = sums.by_recording();
    let squares: Vec<f64> = sums.squares.iter().map(|s| s.iter().sum()).collect();
    for left_out in suspects(&by_recording) {
        let kept = by_recording.len() - left_out.len();
        let share = kept as f64 / by_recording.len() as f64;
        let count = problem.count(Split::Train) as f64 * share;
        problem.left_out.clone_from(&left_out);
        let others = search(problem, &best.x, &ON_THE_WAY, heed);
        problem.left_out = Vec::new();
        let led = |o: &Fit| {
            let kept: f64 =
                (0..squares.len()).filter(|i| !left_out.contains(i)).map(|i| squares[i]).sum();
            o.normal.cost / count < WELL || o.normal.cost < LED * kept
        };
        let Some(others) = others.filter(led) else { continue };
        let Some(found) = search(problem, &others.x, &STOPPING, heed) else { continue };
        if found.normal.cost < (1.0 - BETTER) * best.normal.cost {
            return Some(found);
        }
    }
    None
}

/// Sets of recordings to leave out, most promising first.
fn suspects(by_recording: &[f64]) -> Vec<Vec<usize>> {
    let n = by_recording.len();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|a, b| by_recording[*b].total_cmp(&by_recording[*a]));
    let typical = by_recording[order[n / 2]];
    let outlying =
        order.iter().filter(|i| by_recording[**i] > (OUTLYING * typical).max(FINE)).count();
    let mut sets: Vec<Vec<usize>> = Vec::new();
    for count in [1, 2, n / 2, outlying] {
        let set: Vec<usize> = order.iter().copied().take(count.min(n.saturating_sub(2))).collect();
        if outlying > 0 && !set.is_empty() && !sets.contains(&set) {
            sets.push(set);
        }
    }
    sets
}

/// One search from one place.
pub fn search(
    problem: &mut Problem<'_>,
    start: &[f64],
    stopping: &Stopping,
    heed: &mut Heed<'_>,
) -> Option<Fit> {
    let bounds = problem.bounds();
    let mut heeded = Heeded { problem, heed };
    let Minimum { x, normal, iterations, converged, beyond } =
        minimize(&mut heeded, start, &bounds, stopping)?;
    Some(Fit { x, normal, iterations, converged, beyond })
}

fn reduced(problem: &Problem<'_>, fit: &Fit) -> f64 {
    let count = problem.count(Split::Train).saturating_sub(fit.x.len()).max(1);
    fit.normal.cost / count as f64
}

struct Heeded<'a, 'p, 'h> {
    problem: &'a mut Problem<'p>,
    heed: &'a mut Heed<'h>,
}

impl Residuals for Heeded<'_, '_, '_> {
    fn normal(&mut self, x: &[f64]) -> Option<NormalEquations> {
        Residuals::normal(self.problem, x)
    }
    fn cost(&mut self, x: &[f64]) -> Option<f64> {
        Residuals::cost(self.problem, x)
    }
    fn accepts_step(&mut self, iteration: u32, _x: &[f64], cost: f64) -> bool {
        self.problem.stopped |= !(self.heed)(iteration, cost);
        !self.problem.stopped
    }
}
