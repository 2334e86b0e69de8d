//! The tube around a reference: at each time, all values that the reference takes within the time tolerance, widened by
//! the tolerance of the value.
//!
//! Each value of the run must be within the tube of the reference, and each value of the reference within that of the
//! run, so that a pulse that one of them lacks is found whichever has the wider rows. Between rows, curves are straight;
//! at an event both limits count.
//!
//! Sliding extremes: D. Lemire, "Streaming maximum-minimum filter using no more than three comparisons per element",
//! Nordic Journal of Computing 13, 2006.

use std::collections::VecDeque;

use super::tolerance::Tolerance;

/// The worst departure of a variable from its tube.
#[derive(Clone, PartialEq, Debug)]
pub struct Deviation {
    /// When it is farthest outside, s.
    pub time: f64,
    /// The first instant at which it is outside, s.
    pub first: f64,
    /// The value of the run.
    pub found: f64,
    /// The nearest value of the reference within the time tolerance.
    pub expected: f64,
    /// Half the width of the tube: the tolerance of the value.
    pub allowed: f64,
    /// Part of the compared instants that are outside, from 0 to 1.
    pub part: f64,
}

/// A variable over time: times that do not decrease, and as many values.
#[derive(Clone, Copy, Debug)]
pub struct Curve<'a> {
    /// Times, s.
    pub time: &'a [f64],
    /// Values.
    pub values: &'a [f64],
}

/// The worst departure of a run from a reference; none if it stays within the tube. Compares the time that both have in
/// common.
pub fn deviation(
    found: Curve<'_>,
    reference: Curve<'_>,
    tolerance: &Tolerance,
) -> Option<Deviation> {
    let allowed = tolerance.width(reference.values);
    let shift = tolerance.shift(reference.time);
    let mut worst: Option<Deviation> = None;
    let (mut outside, mut instants) = (0_usize, 0_usize);
    let mut first = f64::INFINITY;
    let mut visit = |of: Curve<'_>, around: Curve<'_>, is_found: bool| {
        let (Some(&begin), Some(&end)) = (around.time.first(), around.time.last()) else { return };
        let mut window = Window::new(around);
        for (&time, &value) in of.time.iter().zip(of.values) {
            if time < begin - shift || time > end + shift {
                continue;
            }
            instants += 1;
            let (low, high) = window.extremes(time - shift, time + shift);
            let nearest = value.clamp(low, high);
            let excess = (value - nearest).abs();
            if excess <= allowed {
                continue;
            }
            outside += 1;
            first = first.min(time);
            if worst.as_ref().is_none_or(|w| excess > (w.found - w.expected).abs()) {
                let (found, expected) = if is_found { (value, nearest) } else { (nearest, value) };
                worst = Some(Deviation { time, first, found, expected, allowed, part: 0.0 });
            }
        }
    };
    visit(found, reference, true);
    visit(reference, found, false);
    let part = outside as f64 / instants.max(1) as f64;
    worst.map(|w| Deviation { first, part, ..w })
}

/// The extremes of a curve over an interval that moves to the right.
struct Window<'a> {
    curve: Curve<'a>,
    /// The first row at or after the left end, and the first after the right one.
    left: usize,
    right: usize,
    /// Rows in the interval that may become its smallest and largest: their values increase and decrease.
    low: VecDeque<usize>,
    high: VecDeque<usize>,
}

impl<'a> Window<'a> {
    fn new(curve: Curve<'a>) -> Window<'a> {
        Window { curve, left: 0, right: 0, low: VecDeque::new(), high: VecDeque::new() }
    }

    /// The smallest and the largest value between two times; neither may be before that of the call before.
    fn extremes(&mut self, from: f64, to: f64) -> (f64, f64) {
        let Curve { time, values } = self.curve;
        while time.get(self.right).is_some_and(|t| *t <= to) {
            let value = values[self.right];
            while self.low.back().is_some_and(|k| values[*k] >= value) {
                self.low.pop_back();
            }
            while self.high.back().is_some_and(|k| values[*k] <= value) {
                self.high.pop_back();
            }
            self.low.push_back(self.right);
            self.high.push_back(self.right);
            self.right += 1;
        }
        while time.get(self.left).is_some_and(|t| *t < from) {
            self.left += 1;
        }
        for rows in [&mut self.low, &mut self.high] {
            while rows.front().is_some_and(|k| *k < self.left) {
                rows.pop_front();
            }
        }
        let ends = [self.value(self.left, from), self.value(self.right, to)];
        let rows = |rows: &VecDeque<usize>| rows.front().map(|k| values[*k]);
        let low = ends.into_iter().chain(rows(&self.low)).fold(f64::INFINITY, f64::min);
        let high = ends.into_iter().chain(rows(&self.high)).fold(f64::NEG_INFINITY, f64::max);
        (low, high)
    }

    /// The value at a time between the row before `row` and this one; that of the end outside of the curve.
    fn value(&self, row: usize, at: f64) -> f64 {
        let Curve { time, values } = self.curve;
        let last = time.len() - 1;
        match row {
            0 => values[0],
            row if row > last => values[last],
            row => {
                let (a, b) = (time[row - 1], time[row]);
                let part = if b > a { (at - a) / (b - a) } else { 1.0 };
                values[row - 1] + part * (values[row] - values[row - 1])
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve<'a>(time: &'a [f64], values: &'a [f64]) -> Curve<'a> {
        Curve { time, values }
    }

    fn sine(n: usize, scale: f64) -> (Vec<f64>, Vec<f64>) {
        let time: Vec<f64> = (0..=n).map(|k| k as f64 / n as f64).collect();
        let values = time.iter().map(|t| scale * (7.0 * t).sin()).collect();
        (time, values)
    }

    #[test]
    fn one_percent_is_found_and_rounding_is_not() {
        let (time, values) = sine(500, 1.0);
        let t = Tolerance::default();
        let (_, off) = sine(500, 1.01);
        let d = deviation(curve(&time, &off), curve(&time, &values), &t).expect("1 % too much");
        assert!((d.found / d.expected - 1.01).abs() < 1e-4, "{d:?}");
        assert_eq!(d.allowed, 1e-12 + 1e-3 * (extent(&values)));
        let (_, same) = sine(500, 1.0 + 1e-9);
        assert_eq!(deviation(curve(&time, &same), curve(&time, &values), &t), None);
    }

    fn extent(values: &[f64]) -> f64 {
        super::super::tolerance::extent(values)
    }

    #[test]
    fn a_jump_may_move_by_the_time_tolerance() {
        let step = |at: f64| ([0.0, at, at, 1.0], [0.0, 0.0, 1.0, 1.0]);
        let (time, values) = step(0.5);
        let t = Tolerance { time: Some(0.01), ..Tolerance::default() };
        for (at, agrees) in [(0.509, true), (0.491, true), (0.52, false), (0.48, false)] {
            let (moved, same) = step(at);
            let found = deviation(curve(&moved, &same), curve(&time, &values), &t);
            assert_eq!(found.is_none(), agrees, "{at}: {found:?}");
        }
    }

    #[test]
    fn a_pulse_that_one_run_lacks_is_found_in_both_directions() {
        let flat = ([0.0, 1.0], [1.0, 1.0]);
        let pulse = ([0.0, 0.5, 0.5, 0.501, 0.501, 1.0], [1.0, 1.0, 2.0, 2.0, 1.0, 1.0]);
        let t = Tolerance { time: Some(0.1), ..Tolerance::default() };
        let (flat, pulse) = (curve(&flat.0, &flat.1), curve(&pulse.0, &pulse.1));
        assert_eq!(deviation(pulse, flat, &t).map(|d| (d.found, d.expected)), Some((2.0, 1.0)));
        assert_eq!(deviation(flat, pulse, &t).map(|d| (d.found, d.expected)), Some((1.0, 2.0)));
    }

    /// The sliding extremes agree with those of a fine scan.
    #[test]
    fn extremes_are_those_of_a_scan() {
        let (time, values) = sine(40, 1.0);
        let mut window = Window::new(curve(&time, &values));
        let at = |t: f64| {
            let t = t.clamp(0.0, 1.0);
            let k = ((t * 40.0) as usize).min(39);
            values[k] + (t * 40.0 - k as f64) * (values[k + 1] - values[k])
        };
        for k in 0..100 {
            let (from, to) = (f64::from(k) / 100.0 - 0.05, f64::from(k) / 100.0 + 0.05);
            let (low, high) = window.extremes(from, to);
            let scan = (0..=1000).map(|j| at(from + 1e-4 * f64::from(j)));
            let (l, h) = scan.fold((9.0, -9.0), |(l, h), v| (f64::min(l, v), f64::max(h, v)));
            assert!((l - low).abs() < 1e-3 && (h - high).abs() < 1e-3, "{k}: {low} {l} {high} {h}");
        }
    }
}
