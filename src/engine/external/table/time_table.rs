//! Interpolation of a function of time, with jumps at repeated times.
//!
//! Between two jumps it is a separate [`Curve`]. Time events are at all points, at jumps only, or
//! nowhere.

use super::Extrapolation;
use super::curve::{Curve, wrapped};
use crate::base::wire::wire_struct;
use crate::numeric::hermite::Smoothness;

/// The instants of time events.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Stops {
    /// At every point.
    Always,
    /// At jumps.
    AtJumps,
    /// Nowhere.
    Never,
}

/// A function of time.
#[derive(Clone, PartialEq, Debug)]
pub struct TimeTable {
    /// The curves between jumps.
    parts: Vec<Curve>,
    /// Instants of events, increasing, before the shift.
    stops: Vec<f64>,
    range: (f64, f64),
    extrapolation: Extrapolation,
    /// The function is 0 before this time, s.
    start: f64,
    /// Shift of the times of the table, s.
    shift: f64,
}

/// Position of a table in time.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Placing {
    /// The function is 0 before this time, s.
    pub start: f64,
    /// Shift of the times of the table, s.
    pub shift: f64,
    /// Instants of events.
    pub stops: Stops,
}

impl TimeTable {
    /// Interpolates points with nondecreasing times. `None` if [`Curve::new`] rejects the points,
    /// or if a time occurs three times.
    pub fn new(
        t: &[f64],
        y: &[f64],
        smoothness: Smoothness,
        extrapolation: Extrapolation,
        placing: Placing,
    ) -> Option<TimeTable> {
        let n = t.len();
        if n == 0 || y.len() != n || t.windows(2).any(|p| p[0] > p[1]) {
            return None;
        }
        let jumps: Vec<usize> = (1..n).filter(|i| t[*i] == t[*i - 1]).collect();
        let mut bounds = vec![0];
        bounds.extend(&jumps);
        bounds.push(n);
        let lone = bounds.len() == 2;
        let mut parts = Vec::with_capacity(bounds.len() - 1);
        for b in bounds.windows(2) {
            // Only the outermost curves are extrapolated.
            let beyond = if lone || extrapolation != Extrapolation::Periodic {
                extrapolation
            } else {
                Extrapolation::Hold
            };
            parts.push(Curve::new(&t[b[0]..b[1]], &y[b[0]..b[1]], smoothness, beyond)?);
        }
        let stops = match placing.stops {
            Stops::Always => {
                let mut all = t.to_vec();
                all.dedup();
                all
            }
            Stops::AtJumps => jumps.iter().map(|i| t[*i]).collect(),
            Stops::Never => Vec::new(),
        };
        let Placing { start, shift, .. } = placing;
        Some(TimeTable { parts, stops, range: (t[0], t[n - 1]), extrapolation, start, shift })
    }

    /// The first and the last time of the table, s, without the shift.
    pub fn range(&self) -> (f64, f64) {
        self.range
    }

    /// The derivative of this order at time `t`, s. Jumps from the next event, at `next`, on have
    /// not happened yet.
    pub fn at(&self, t: f64, next: f64, order: u8) -> f64 {
        let slack = slack(t);
        let held = t + slack >= next;
        if t + slack < self.start || (held && next <= self.start) {
            return 0.0;
        }
        // Rounding of the event time must not select the wrong side.
        let table_time = if held { next } else { t } - self.shift;
        let inside = match self.extrapolation {
            Extrapolation::Periodic => wrapped(table_time, self.range.0, self.range.1),
            _ => table_time,
        };
        if held {
            if self.extrapolation == Extrapolation::Periodic && near(inside, self.range.0, slack) {
                let last = &self.parts[self.parts.len() - 1];
                return last.before(self.range.1, order);
            }
            let snapped = self.snapped(inside, slack);
            return self.part(|start| start < snapped).before(snapped, order);
        }
        let snapped = self.snapped(inside, slack);
        self.part(|start| start <= snapped).at(snapped, order)
    }

    /// The last curve whose start is before a time, or the first.
    fn part(&self, is_before: impl Fn(f64) -> bool) -> &Curve {
        let later = self.parts.partition_point(|p| is_before(p.range().0));
        &self.parts[later.saturating_sub(1)]
    }

    /// The first instant of events after `t`, s, shifted by these times.
    fn stop_after(&self, t: f64, shifted: impl Fn(f64) -> f64) -> Option<f64> {
        let passed = self.stops.partition_point(|s| shifted(*s) <= t);
        self.stops.get(passed).map(|s| shifted(*s))
    }

    /// The time of the first event after `t`, s; the largest finite number if there is none.
    pub fn next_stop(&self, t: f64) -> f64 {
        let slack = slack(t);
        if t + slack < self.start {
            return self.start;
        }
        let (first, last) = self.range;
        let table_time = t - self.shift;
        let period = last - first;
        if self.extrapolation == Extrapolation::Periodic && period > 0.0 && !self.stops.is_empty() {
            let turn = ((table_time + slack - first) / period).floor();
            for turn in [turn, turn + 1.0] {
                let later = self.stop_after(t + slack, |s| s + turn * period + self.shift);
                if let Some(stop) = later {
                    return stop;
                }
            }
        }
        self.stop_after(t + slack, |s| s + self.shift).unwrap_or(f64::MAX)
    }

    /// The time of the table that equals `t` up to rounding, else `t` itself.
    fn snapped(&self, t: f64, slack: f64) -> f64 {
        let k = self.stops.partition_point(|s| *s < t - slack);
        match self.stops.get(k) {
            Some(stop) if near(*stop, t, slack) => *stop,
            _ => t,
        }
    }
}

fn near(a: f64, b: f64, slack: f64) -> bool {
    (a - b).abs() <= slack
}

/// Rounding error of a scaled and shifted time, s.
fn slack(t: f64) -> f64 {
    8.0 * f64::EPSILON * t.abs().max(f64::MIN_POSITIVE)
}

wire_struct!(TimeTable { parts, stops, range, extrapolation, start, shift });

#[cfg(test)]
mod tests {
    use super::*;

    const NOW: Placing = Placing { start: 0.0, shift: 0.0, stops: Stops::AtJumps };

    fn step(extrapolation: Extrapolation, placing: Placing) -> TimeTable {
        let (t, y) = ([0.0, 1.0, 1.0, 3.0], [0.0, 2.0, 5.0, 5.0]);
        TimeTable::new(&t, &y, Smoothness::Linear, extrapolation, placing).unwrap()
    }

    #[test]
    fn a_jump_happens_with_its_event() {
        let c = step(Extrapolation::Hold, NOW);
        assert_eq!(c.next_stop(0.0), 1.0);
        assert_eq!(c.at(1.0, 1.0, 0), 2.0);
        assert_eq!(c.at(1.0, 1.0, 1), 2.0);
        assert_eq!(c.next_stop(1.0), f64::MAX);
        assert_eq!(c.at(1.0, f64::MAX, 0), 5.0);
        assert_eq!(c.at(9.0, f64::MAX, 0), 5.0);
    }

    /// A table of stairs with as many jumps as rows, and a search for each event: the cost is that of a few thousand.
    #[test]
    fn long_tables_are_searched_quickly() {
        let n = 200_000;
        let t: Vec<f64> = (0..n).map(|k| f64::from((k + 1) / 2)).collect();
        let y: Vec<f64> = (0..n).map(|k| f64::from(k / 2)).collect();
        let c = TimeTable::new(&t, &y, Smoothness::Linear, Extrapolation::Hold, NOW).unwrap();
        let (mut now, mut events) = (0.0, 0);
        while c.next_stop(now) < f64::MAX {
            now = c.next_stop(now);
            events += 1;
            assert_eq!((c.at(now, now, 0), c.at(now, f64::MAX, 0)), (now - 1.0, now));
        }
        assert_eq!(events, n / 2 - 1);
    }

    #[test]
    fn rounding_does_not_repeat_an_event() {
        let c = step(Extrapolation::Hold, NOW);
        let t = 1.0 - f64::EPSILON;
        assert_eq!(c.next_stop(t), f64::MAX);
        assert_eq!(c.at(t, f64::MAX, 0), 5.0);
    }

    #[test]
    fn it_is_zero_before_its_start_and_shifted_after() {
        let c = step(Extrapolation::Hold, Placing { start: 2.0, shift: 2.0, ..NOW });
        assert_eq!(c.next_stop(0.0), 2.0);
        assert_eq!(c.at(1.0, 2.0, 0), 0.0);
        assert_eq!(c.at(2.0, 2.0, 0), 0.0);
        assert_eq!(c.at(2.5, 3.0, 0), 1.0);
        assert_eq!(c.next_stop(2.0), 3.0);
    }

    #[test]
    fn periods_repeat_values_and_events() {
        let c = step(Extrapolation::Periodic, Placing { stops: Stops::Always, ..NOW });
        let times: Vec<f64> =
            std::iter::successors(Some(c.next_stop(0.0)), |t| Some(c.next_stop(*t)))
                .take(5)
                .collect();
        assert_eq!(times, [1.0, 3.0, 4.0, 6.0, 7.0]);
        assert_eq!(c.at(3.0, 3.0, 0), 5.0);
        assert_eq!(c.at(3.0, 4.0, 0), 0.0);
        assert_eq!(c.at(3.5, 4.0, 0), 1.0);
        assert_eq!(c.at(4.0, 4.0, 0), 2.0);
        assert_eq!(c.at(4.0, 6.0, 0), 5.0);
    }

    #[test]
    fn constant_segments_change_at_their_points() {
        let c = TimeTable::new(
            &[0.0, 1.0, 2.0],
            &[3.0, 4.0, 5.0],
            Smoothness::Constant,
            Extrapolation::Hold,
            Placing { stops: Stops::Always, ..NOW },
        )
        .unwrap();
        assert_eq!(c.at(0.5, 1.0, 0), 3.0);
        assert_eq!(c.at(1.0, 1.0, 0), 3.0);
        assert_eq!(c.at(1.0, 2.0, 0), 4.0);
        assert_eq!(c.at(2.0, f64::MAX, 0), 5.0);
    }
}
