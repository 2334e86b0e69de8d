//! Cutting recordings into windows, each a run of its own.

use crate::numeric::time_series::TimeSeries;

use super::data::Recording;

/// The source of an initial value.
pub struct InitialSignal {
    /// The signal.
    pub series: TimeSeries,
    /// Order of its derivative by time that counts.
    pub order: u8,
}

impl InitialSignal {
    /// The initial value of a run that begins at `t`, in SI units.
    pub fn at(&self, t: f64) -> f64 {
        self.series.value(t, self.order)
    }
}

/// How a recording is cut into runs.
pub struct Cut {
    /// First and last time, s.
    pub part: (f64, f64),
    /// Length of a window, s; infinite for the whole recording.
    pub window: f64,
    /// Time at the start of each window that is not compared, s.
    pub skip: f64,
    /// Only every n-th row is compared.
    pub every: usize,
}

impl Cut {
    /// The runs of a recording. `initial_signals` holds the signals of their initial values.
    pub fn apply(&self, whole: &Recording, initial_signals: &[InitialSignal]) -> Vec<Recording> {
        let time = &whole.time;
        let mut first = time.partition_point(|t| *t < self.part.0);
        let end = time.partition_point(|t| *t <= self.part.1);
        let mut out = Vec::new();
        let mut number = 0;
        while first + 1 < end {
            let t0 = time[first];
            // A remainder shorter than half a window is added to the last window.
            let mut last = end;
            if self.window.is_finite() && time[end - 1] - t0 > 1.5 * self.window {
                last = time.partition_point(|t| *t <= t0 + self.window).min(end);
                if last < first + 2 {
                    // A gap longer than a window: the next window begins after it.
                    first += 1;
                    continue;
                }
            }
            number += 1;
            let compared =
                |k: &usize| (*k == first || (*k - first).is_multiple_of(self.every)) && *k < last;
            let rows: Vec<usize> = (first..last).filter(compared).collect();
            let signal = |values: &Vec<f64>| {
                let one = |k: &usize| if time[*k] - t0 < self.skip { f64::NAN } else { values[*k] };
                rows.iter().map(one).collect::<Vec<f64>>()
            };
            let signals: Vec<Vec<f64>> = whole.signals.iter().map(signal).collect();
            if signals.iter().flatten().any(|v| !v.is_nan()) {
                let cut = last < end || number > 1;
                let name =
                    if cut { format!("{} {number}", whole.name) } else { whole.name.clone() };
                out.push(Recording {
                    name,
                    starts: initial_signals.iter().map(|b| b.at(t0)).collect(),
                    start: Some(t0),
                    time: rows.iter().map(|k| time[*k]).collect(),
                    signals,
                    ..whole.clone()
                });
            }
            // The last row of a window is the first of the next.
            first = if last == end { end } else { last - 1 };
        }
        out
    }
}
