//! The rows of a run that are needed to draw each of its curves by straight lines within a tolerance.
//!
//! Swinging door: E. H. Bristol, "Swinging door trending: adaptive trend recording?", ISA National Conference 1990.

use super::tolerance::Tolerance;
use crate::ir::trajectory::{Column, Trajectory};

/// Part of the tolerance of a comparison that leaving out rows may use.
const PART: f64 = 0.1;
/// Digits after the first one of a value that is kept.
const DIGITS: usize = 9;

/// Some columns of a run, with the rows that they need. Both rows of each event are kept, and values have ten digits.
pub fn thinned(run: &Trajectory, columns: &[(usize, Tolerance)]) -> Trajectory {
    let names: Vec<Column> = columns.iter().map(|(k, _)| run.columns[*k].clone()).collect();
    let mut out = Trajectory::new(names);
    let curves: Vec<(&[f64], f64)> = columns
        .iter()
        .map(|(k, t)| (run.data[*k].as_slice(), PART * t.width(&run.data[*k])))
        .collect();
    for row in rows(&run.time, &curves) {
        let values: Vec<f64> = curves.iter().map(|(values, _)| rounded(values[row])).collect();
        out.push(run.time[row], &values);
    }
    out
}

/// The rows to keep, of curves with the tolerance of each.
fn rows(time: &[f64], curves: &[(&[f64], f64)]) -> Vec<usize> {
    let mut kept = Vec::new();
    let mut doors = vec![(f64::NEG_INFINITY, f64::INFINITY); curves.len()];
    for row in 0..time.len() {
        let Some(&from) = kept.last() else {
            kept.push(row);
            continue;
        };
        // The rows between the last one that is kept and this one must be near the line between both.
        let length = time[row] - time[from];
        let slope = |values: &[f64], by: f64| (values[row] + by - values[from]) / length;
        let fits = length > 0.0
            && curves.iter().zip(&doors).all(|((values, _), (low, high))| {
                let slope = slope(values, 0.0);
                *low <= slope && slope <= *high
            });
        if !fits && row > from + 1 {
            kept.push(row - 1);
            doors.fill((f64::NEG_INFINITY, f64::INFINITY));
        }
        let from = kept.last().copied().unwrap_or(0);
        let length = time[row] - time[from];
        if length <= 0.0 {
            // The right limit of an event.
            if row > from {
                kept.push(row);
                doors.fill((f64::NEG_INFINITY, f64::INFINITY));
            }
            continue;
        }
        for ((values, width), (low, high)) in curves.iter().zip(&mut doors) {
            let slope = |by: f64| (values[row] + by - values[from]) / length;
            *low = low.max(slope(-width));
            *high = high.min(slope(*width));
        }
    }
    if let Some(last) = time.len().checked_sub(1).filter(|last| kept.last() != Some(last)) {
        kept.push(last);
    }
    kept
}

/// The value with ten significant digits: a text that a person can compare.
fn rounded(value: f64) -> f64 {
    format!("{value:.DIGITS$e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::super::tube::{Curve, deviation};
    use super::*;

    #[test]
    fn straight_lines_keep_their_ends_and_events_both_rows() {
        let mut run = Trajectory::new(vec![Column::new("x", "m")]);
        for k in 0..=100 {
            run.push(f64::from(k), &[2.0 * f64::from(k)]);
        }
        for k in 100..=200 {
            run.push(f64::from(k), &[-f64::from(k)]);
        }
        let thin = thinned(&run, &[(0, Tolerance::default())]);
        assert_eq!(thin.time, [0.0, 100.0, 100.0, 200.0]);
        assert_eq!(*thin.data[0], [0.0, 200.0, -100.0, -200.0]);
    }

    #[test]
    fn a_thinned_run_agrees_with_the_whole_one_within_a_tenth() {
        let mut run = Trajectory::new(vec![Column::new("x", "m"), Column::new("y", "m")]);
        for k in 0..=5000 {
            let t = f64::from(k) * 1e-3;
            run.push(t, &[(3.0 * t).sin(), (-t).exp() * (40.0 * t).cos()]);
        }
        let tolerance = Tolerance { time: Some(0.0), ..Tolerance::default() };
        let thin = thinned(&run, &[(0, tolerance), (1, tolerance)]);
        assert!(thin.rows() < 2000, "{} rows", thin.rows());
        let tenth = Tolerance { relative: 1.01e-4, ..tolerance };
        for k in 0..2 {
            let whole = Curve { time: &run.time, values: &run.data[k] };
            let part = Curve { time: &thin.time, values: &thin.data[k] };
            assert_eq!(deviation(whole, part, &tenth), None, "column {k}");
        }
    }
}
