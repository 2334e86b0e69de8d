//! A calibration as a table for the terminal, and numbers with their significant digits.

use super::data::Split;
use super::result::{Calibration, Estimate, OwnValues};

impl Calibration {
    /// As a table for the terminal.
    pub fn table(&self) -> String {
        let mut rows = vec![
            ["parameter", "value", "std. error", "95 % interval", "start", "unit", ""]
                .map(str::to_owned),
        ];
        for e in &self.estimates {
            rows.push([
                e.name.clone(),
                shown(e.value, e.error),
                shown(e.error, 10.0 * e.error),
                self.interval_shown(e),
                shown(e.start, 0.0),
                e.unit.clone(),
                remark(e).to_owned(),
            ]);
        }
        let mut out = aligned(&rows, 6);
        for line in &self.directions {
            out.push_str(&format!("{line}\n"));
        }
        for (a, b, rho) in self.strong_correlations() {
            out.push_str(&format!("`{a}` and `{b}` are correlated: {rho:.3}\n"));
        }
        out.push_str(&own_table(&self.own));
        out.push('\n');
        let mut head = vec!["rmse (chi2 red.)".to_owned()];
        head.extend(self.channels.iter().map(|c| format!("{}, {}", c.column, c.unit)));
        head.push("all".to_owned());
        let mut rows = vec![head];
        for split in Split::ALL {
            let all = self.quality(split, None);
            if all.count == 0 {
                continue;
            }
            let mut row = vec![split.name().to_owned()];
            row.extend(self.channels.iter().enumerate().map(|(k, c)| {
                let q = self.quality(split, Some(k));
                format!("{} ({:.3})", rmse_shown(q.rmse(c.sigma)), q.reduced())
            }));
            let chi = if split == Split::Train { self.reduced_train() } else { all.reduced() };
            row.push(format!("({chi:.4})"));
            rows.push(row);
        }
        out.push_str(&aligned(&rows, 0));
        out
    }
}

/// The values that recordings have for themselves, as a table; empty without any.
pub fn own_table(own: &[OwnValues]) -> String {
    let Some(first) = own.first() else { return String::new() };
    let mut head = vec!["recording".to_owned(), "split".to_owned()];
    head.extend(first.values.iter().map(|v| match v.unit.as_str() {
        "" | "1" => v.name.clone(),
        unit => format!("{}, {unit}", v.name),
    }));
    let mut rows = vec![head];
    for o in own {
        let mut row = vec![o.recording.clone(), o.split.name().to_owned()];
        row.extend(
            o.values.iter().map(|v| {
                format!("{} ± {}", shown(v.value, v.error), shown(v.error, 10.0 * v.error))
            }),
        );
        rows.push(row);
    }
    format!("\n{}", aligned(&rows, 0))
}

/// A remark on an estimate; empty if there is nothing to remark.
pub fn remark(e: &Estimate) -> &'static str {
    match (e.at_bound, e.undetermined) {
        (true, _) => "at its bound",
        (_, true) => "not determined",
        _ => "",
    }
}

/// A number with its significant digits: to the second digit of its error, or five digits if it has none.
pub fn shown(value: f64, error: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        let sign = if value < 0.0 { "-" } else { "" };
        return format!("{sign}inf");
    }
    let size = value.abs().log10().floor();
    // Digits after the first one.
    let digits = if error > 0.0 && error.is_finite() {
        (size - error.log10().floor() + 1.0).clamp(1.0, 9.0) as usize
    } else {
        4
    };
    let text = format!("{value:.digits$e}");
    let rounded: f64 = text.parse().unwrap_or(value);
    let size = rounded.abs().log10().floor() as i32;
    if (-4..6).contains(&size) {
        let decimals = (digits as i32 - size).max(0) as usize;
        format!("{rounded:.decimals$}")
    } else {
        text
    }
}

/// The root of a mean square, in four digits.
pub fn rmse_shown(rmse: f64) -> String {
    shown(rmse, 0.01 * rmse)
}

/// Columns of equal width; those from the second on to the right, but for the `left` last ones.
pub fn aligned<R: AsRef<[String]>>(rows: &[R], left_from: usize) -> String {
    let columns = rows.first().map_or(0, |r| r.as_ref().len());
    let width = |k: usize| rows.iter().map(|r| r.as_ref()[k].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut out = String::new();
    for row in rows {
        let mut line = String::new();
        for (k, (cell, width)) in row.as_ref().iter().zip(&widths).enumerate() {
            let to_the_left = k == 0 || (left_from > 0 && k + 1 >= left_from);
            let cell =
                if to_the_left { format!("{cell:<width$}") } else { format!("{cell:>width$}") };
            line.push_str(if k == 0 { "" } else { "  " });
            line.push_str(&cell);
        }
        out.push_str(line.trim_end());
        out.push('\n');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_that_mean_something() {
        assert_eq!(shown(1.227_36, 0.0123), "1.227");
        assert_eq!(shown(2.004e-6, 1.1e-8), "2.004e-6");
        assert_eq!(shown(1499.6, 130.0), "1500");
        assert_eq!(shown(9.999_96, 0.0), "10.000");
        assert_eq!(shown(-0.5, 3.0), "-0.50");
        assert_eq!(shown(f64::INFINITY, 1.0), "inf");
        assert_eq!(shown(0.0, 1.0), "0");
    }
}
