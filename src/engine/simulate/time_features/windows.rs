//! A look over a run part by part, on a grid so fine that a look over the whole run would cost more than what it saves.

use super::look::Look;

/// Points of the grid in each period of a sine or cosine.
const POINTS_PER_PERIOD: f64 = 16.0;

/// Distance of the points of the grid for an oscillation of this angular frequency, s.
pub fn spacing_for(angular_frequency: f64) -> f64 {
    std::f64::consts::TAU / (POINTS_PER_PERIOD * angular_frequency)
}

/// A look that goes on as the run does.
pub struct Windows<'p> {
    /// The expressions.
    pub look: Look<'p>,
    /// For each slot, whether a sine or cosine in it counts.
    sharpened: Vec<bool>,
    /// Distance of the points of the grid, s.
    spacing: f64,
    /// Least distance, s.
    least_spacing: f64,
    /// Intervals of a window.
    intervals: f64,
    /// Where the look begins and ends, s.
    range: (f64, f64),
    /// Where the windows so far end, s.
    covered: f64,
    /// Instants of features in the last windows, ascending, s.
    instants: Vec<f64>,
    next: usize,
}

impl<'p> Windows<'p> {
    /// Windows over a range, with points at this distance.
    pub fn new(
        look: Look<'p>,
        sharpened: Vec<bool>,
        range: (f64, f64),
        spacing: f64,
        intervals: f64,
    ) -> Windows<'p> {
        let (covered, least_spacing) = (range.0, spacing);
        let (instants, next) = (Vec::new(), 0);
        Windows {
            look,
            sharpened,
            spacing,
            least_spacing,
            intervals,
            range,
            covered,
            instants,
            next,
        }
    }

    /// Begins again.
    pub fn restart(&mut self, range: (f64, f64), spacing: f64) {
        (self.range, self.covered, self.spacing) = (range, range.0, spacing);
        self.instants.clear();
        self.next = 0;
    }

    /// The first instant after `t`, if there is one before `t_stop`, s.
    pub fn first_between(&mut self, t: f64, t_stop: f64) -> Option<f64> {
        loop {
            while self.instants.get(self.next).is_some_and(|at| *at <= t) {
                self.next += 1;
            }
            if let Some(at) = self.instants.get(self.next) {
                return Some(*at).filter(|at| *at < t_stop);
            }
            if self.covered >= t_stop.min(self.range.1) {
                return None;
            }
            self.advance();
        }
    }

    /// Looks over the next window, with a finer grid if its oscillations ask for one.
    fn advance(&mut self) {
        // An extremum takes three points.
        let from = (self.covered - 2.0 * self.spacing).max(self.range.0);
        let left = ((self.range.1 - from) / self.spacing).ceil().max(1.0);
        let intervals = left.min(self.intervals);
        let end = from + intervals * self.spacing;
        // Far from zero the points may be closer than doubles are.
        let to = if intervals < left && end > self.covered { end } else { self.range.1 };
        self.look.found.clear();
        self.look.scan(from, to, intervals as usize);
        let wanted = spacing_for(self.look.fastest(&self.sharpened)).max(self.least_spacing);
        if wanted < REFINED * self.spacing {
            self.spacing = wanted;
            return;
        }
        self.covered = to;
        self.instants.clear();
        self.instants.append(&mut self.look.found);
        self.instants.sort_by(f64::total_cmp);
        self.next = 0;
    }
}

/// A grid is made finer if a finer one than this share of its spacing is wanted.
const REFINED: f64 = 0.99;
