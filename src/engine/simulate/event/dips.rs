//! Samples of the zero-crossing indicators within a step, and the intervals between them in which
//! an indicator may reach zero although it has the same sign at both ends.
//!
//! Where the absolute value of an indicator is convex, it lies above the chords of the neighbouring
//! intervals, extended into the interval. Only where these extensions meet below zero can it reach
//! zero. Such an interval is bisected until it is excluded or a change is found; near a simple
//! minimum above zero a few bisections exclude it.

/// Maximum number of samples in one step: those of the probes, and bisections.
const MAX_SAMPLES: usize = 96;
/// Bisections of an interval that has a neighbour on one side only: for the last of a step, whose
/// other neighbour follows with the next step, they find what is wider than an eighth.
const ONE_SIDED_DEPTH: u32 = 3;
/// Range of an indicator within a step, relative to its size, below which it is constant up to rounding.
const ROUNDING: f64 = 1e-3;
/// An indicator at the start of a step, relative to the next sample, below which it leaves its
/// threshold rather than returning to it.
const DEPARTURE: f64 = 0.5;

/// Indicators at ascending instants.
#[derive(Debug)]
pub struct Samples {
    width: usize,
    /// Instants, s, and the number of bisections that led to the interval after each.
    times: Vec<(f64, u32)>,
    /// Row by row.
    values: Vec<f64>,
    /// The sample before the first; its interval has been examined.
    has_predecessor: bool,
}

impl Samples {
    /// No samples of this many indicators.
    pub fn new(width: usize) -> Self {
        Samples {
            width,
            times: Vec::with_capacity(MAX_SAMPLES),
            values: Vec::with_capacity(MAX_SAMPLES * width),
            has_predecessor: false,
        }
    }

    /// Starts a step at `t0`: keeps the last two samples if the last step ended there.
    pub fn begin(&mut self, t0: f64) {
        let n = self.times.len();
        self.has_predecessor = n >= 2 && self.times[n - 1].0 == t0;
        let kept = if self.has_predecessor { n - 2 } else { n };
        self.times.drain(..kept);
        self.values.drain(..kept * self.width);
        self.times.iter_mut().for_each(|(_, depth)| *depth = 0);
    }

    /// Adds the indicators at an instant after all others.
    pub fn add(&mut self, t: f64, indicators: &[f64]) {
        if self.times.last().is_none_or(|last| last.0 < t) && self.times.len() < MAX_SAMPLES {
            self.times.push((t, 0));
            self.values.extend_from_slice(indicators);
        }
    }

    /// Ends a step at `t1`; if its last sample is not there, the next step has no predecessor.
    pub fn end(&mut self, t1: f64) {
        if self.times.last().is_none_or(|last| last.0 != t1) {
            self.clear();
        }
    }

    /// Forgets all samples.
    pub fn clear(&mut self) {
        self.times.clear();
        self.values.clear();
    }

    /// Splits an interval; false if there are too many samples.
    pub fn insert(&mut self, interval: usize, t: f64, indicators: &[f64]) -> bool {
        if self.times.len() >= MAX_SAMPLES {
            return false;
        }
        let depth = self.times[interval].1 + 1;
        self.times[interval].1 = depth;
        self.times.insert(interval + 1, (t, depth));
        let at = (interval + 1) * self.width;
        self.values.extend_from_slice(indicators);
        self.values[at..].rotate_right(self.width);
        true
    }

    /// The ends of an interval, s.
    pub fn interval(&self, interval: usize) -> (f64, f64) {
        (self.times[interval].0, self.times[interval + 1].0)
    }

    /// The middle of an interval, s.
    pub fn middle(&self, interval: usize) -> f64 {
        let (left, right) = self.interval(interval);
        left + 0.5 * (right - left)
    }

    /// The first interval from `from` on in which one of `relations` may change, and the number of
    /// bisections that led to it.
    pub fn next_suspect(&self, relations: &[u32], from: usize) -> Option<(usize, u32)> {
        let first = from.max(usize::from(self.has_predecessor));
        let is_suspect = |k: &usize| {
            let depth = self.times[*k].1;
            relations.iter().any(|r| self.may_reach_zero(*k, *r as usize, depth))
        };
        let found = (first..self.times.len().saturating_sub(1)).find(is_suspect)?;
        Some((found, self.times[found].1))
    }

    /// True if an indicator turns back more than once among the samples of the step, so that between
    /// them it may have turned as well.
    pub fn is_restless(&self, indicator: u32) -> bool {
        let value = |k: usize| self.values[k * self.width + indicator as usize];
        let own = usize::from(self.has_predecessor)..self.times.len();
        let (mut turns, mut last_sign) = (0, 0.0);
        for k in own.clone().skip(1) {
            let change = value(k) - value(k - 1);
            turns += u32::from(change * last_sign < 0.0);
            last_sign = if change == 0.0 { last_sign } else { change.signum() };
        }
        if turns <= 1 {
            return false;
        }
        // Rounding errors turn as well.
        let start = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
        let (least, greatest, size) = own.map(value).fold(start, |(least, greatest, size), g| {
            (least.min(g), greatest.max(g), size.max(g.abs()))
        });
        greatest - least > ROUNDING * size
    }

    /// True if the samples of the step and `start`, its first, have a smaller range than `change`, which is more than
    /// rounding. They have none at all if the step is a multiple of a period.
    pub fn is_outrun(&self, indicator: u32, start: f64, change: f64) -> bool {
        let first = usize::from(self.has_predecessor);
        let (mut least, mut greatest, mut size) = (start, start, start.abs());
        for k in first..self.times.len() {
            let g = self.values[k * self.width + indicator as usize];
            (least, greatest, size) = (least.min(g), greatest.max(g), size.max(g.abs()));
        }
        let range = greatest - least;
        range < change && change > ROUNDING * size
    }

    fn at(&self, k: usize, indicator: usize) -> (f64, f64) {
        (self.times[k].0, self.values[k * self.width + indicator].abs())
    }

    fn may_reach_zero(&self, k: usize, indicator: usize, depth: u32) -> bool {
        let (a, ga) = self.at(k, indicator);
        let (b, gb) = self.at(k + 1, indicator);
        // Most indicators do not turn: no slopes are needed to see that.
        let falls = k == 0 || ga < self.at(k - 1, indicator).1;
        let rises = k + 2 >= self.times.len() || self.at(k + 2, indicator).1 > gb;
        if !falls || !rises {
            return false;
        }
        let slope = |from: (f64, f64), to: (f64, f64)| (to.1 - from.1) / (to.0 - from.0);
        let falling = (k > 0).then(|| slope(self.at(k - 1, indicator), (a, ga)));
        let rising = (k + 2 < self.times.len()).then(|| slope((b, gb), self.at(k + 2, indicator)));
        // NaN excludes an interval: comparisons with it are false.
        match (falling, rising) {
            (Some(falling), Some(rising)) => {
                // Where the extensions ga + falling (t - a) and gb + rising (t - b) meet.
                falling < 0.0 && rising > 0.0 && {
                    let t = (gb - ga + falling * a - rising * b) / (falling - rising);
                    ga + falling * (t.clamp(a, b) - a) <= 0.0
                }
            }
            (Some(falling), None) => {
                depth < ONE_SIDED_DEPTH && falling < 0.0 && ga + falling * (b - a) <= 0.0
            }
            (None, Some(rising)) => {
                depth < ONE_SIDED_DEPTH
                    && ga > DEPARTURE * gb
                    && rising > 0.0
                    && gb - rising * (b - a) <= 0.0
            }
            (None, None) => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bisections of the search for zeros of `g`, and where it is smallest among the samples.
    fn search(g: impl Fn(f64) -> f64) -> (usize, f64) {
        let mut samples = Samples::new(1);
        samples.begin(0.0);
        for t in [0.0, 0.3, 0.6, 1.0] {
            samples.add(t, &[g(t)]);
        }
        let mut bisections = 0;
        let mut from = 0;
        while let Some((k, depth)) = samples.next_suspect(&[0], from) {
            from = if depth >= 26 { k + 1 } else { k };
            if from == k {
                let t = samples.middle(k);
                bisections += 1;
                if !samples.insert(k, t, &[g(t)]) {
                    break;
                }
            }
        }
        let least = samples.values.iter().copied().fold(f64::INFINITY, f64::min);
        (bisections, least)
    }

    #[test]
    fn a_distant_indicator_costs_nothing() {
        assert!(search(|t| 2.0 + (7.0 * t).sin()).0 <= 1);
        // At the end of a step, without a neighbour behind it, a decay takes a bisection.
        assert_eq!(search(|t| (-3.0 * t).exp()).0, 1);
        assert_eq!(search(|t| t).0, 0);
        assert_eq!(search(|t| t * (2.0 - t)).0, 0);
    }

    #[test]
    fn a_minimum_is_approached_until_it_is_excluded() {
        // Above zero: a few bisections exclude it.
        assert!(search(|t| (t - 0.45).powi(2) + 0.01).0 < 8);
        // Touching zero: the distance of the nearest sample falls below 1e-6.
        assert!(search(|t| (t - 0.456).powi(2)).1 < 1e-12);
        // A corner is not smooth, and is found as well.
        assert!(search(|t| (t - 0.456).abs()).1 < 1e-6);
    }

    #[test]
    fn samples_at_multiples_of_a_period_are_outrun() {
        let g = |t: f64| 0.5 - (12.0 * std::f64::consts::PI * t).sin();
        let mut samples = Samples::new(1);
        samples.begin(0.0);
        [1.0 / 3.0, 2.0 / 3.0, 1.0].iter().for_each(|t| samples.add(*t, &[g(*t)]));
        assert!(samples.is_outrun(0, g(0.0), 12.0) && !samples.is_outrun(0, g(0.0), 1e-9));
    }

    #[test]
    fn the_predecessor_of_a_step_counts() {
        let g = |t: f64| (t - 1.02_f64).powi(2);
        let mut samples = Samples::new(1);
        samples.begin(0.0);
        [0.0, 0.5, 1.0].iter().for_each(|t| samples.add(*t, &[g(*t)]));
        samples.begin(1.0);
        [1.3, 2.0].iter().for_each(|t| samples.add(*t, &[g(*t)]));
        assert_eq!(samples.next_suspect(&[0], 0), Some((1, 0)));
    }
}
