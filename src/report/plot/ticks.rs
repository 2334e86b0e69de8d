//! Tick marks at round numbers.

/// Tick marks at round values within a range.
#[derive(Clone, PartialEq, Debug)]
pub struct Ticks {
    /// The marks, ascending, all within the range.
    pub values: Vec<f64>,
    /// The text at each mark.
    pub labels: Vec<String>,
}

/// About `wanted` marks in `low..=high`, at multiples of 1, 2 or 5 times a power of ten.
/// An empty range (or one that is not finite) has one mark, at `low`.
pub fn ticks(low: f64, high: f64, wanted: usize) -> Ticks {
    let step = round_step((high - low) / wanted.max(1) as f64);
    // Beyond 2^53 steps from zero the multiples are no longer distinct numbers.
    let countable = |bound: f64| (bound / step).abs() < 9e15;
    if !(step > 0.0 && step.is_finite() && countable(low) && countable(high)) {
        return Ticks { values: vec![low], labels: vec![label(low, 0)] };
    }
    // A bound that misses a multiple by a rounding error still gets its mark.
    let slack = 1e-9;
    let first = (low / step - slack).ceil() as i64;
    let last = (high / step + slack).floor() as i64;
    let decimals = (-(step.log10() + slack).floor()).max(0.0) as usize;
    let values: Vec<f64> = (first..=last).map(|i| i as f64 * step).collect();
    let labels = values.iter().map(|&v| label(v, decimals)).collect();
    Ticks { values, labels }
}

/// Marks at the powers of ten within a range of a logarithmic axis, whose ends are given as
/// logarithms.
pub fn decades(low: f64, high: f64) -> Ticks {
    let (first, last) = ((low - 1e-9).ceil() as i32, (high + 1e-9).floor() as i32);
    let every = ((last - first) / 12 + 1) as usize;
    let powers = (first..=last).step_by(every);
    let label = |power: i32| match power {
        -2..=4 => format!("{}", 10_f64.powi(power)),
        _ => {
            let raised = |c: char| match c {
                '-' => '⁻',
                _ => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹']
                    [c.to_digit(10).unwrap_or(0) as usize],
            };
            format!("10{}", power.to_string().chars().map(raised).collect::<String>())
        }
    };
    Ticks { values: powers.clone().map(f64::from).collect(), labels: powers.map(label).collect() }
}

/// The number among 1, 2, 5 times a power of ten with the ratio to `rough` closest to one.
fn round_step(rough: f64) -> f64 {
    let power = 10_f64.powf(rough.log10().floor());
    // The boundaries are the geometric means of adjacent numbers.
    let digit = match rough / power {
        r if r < 2_f64.sqrt() => 1.0,
        r if r < 10_f64.sqrt() => 2.0,
        r if r < 50_f64.sqrt() => 5.0,
        _ => 10.0,
    };
    digit * power
}

/// Uses a typographic minus sign, and none for zero.
fn label(value: f64, decimals: usize) -> String {
    let text = format!("{:.decimals$}", value.abs());
    let zero = text.chars().all(|c| matches!(c, '0' | '.'));
    if value < 0.0 && !zero { format!("\u{2212}{text}") } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(low: f64, high: f64, wanted: usize) -> Vec<String> {
        ticks(low, high, wanted).labels
    }

    #[test]
    fn steps_are_one_two_or_five() {
        assert_eq!(labels(0.0, 120.0, 6), ["0", "20", "40", "60", "80", "100", "120"]);
        assert_eq!(labels(0.0, 1.0, 4), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(-0.2, 0.2, 4), ["\u{2212}0.2", "\u{2212}0.1", "0.0", "0.1", "0.2"]);
        assert_eq!(labels(0.9, 7.1, 4), ["2", "4", "6"]);
        assert_eq!(labels(-560.0, 640.0, 3), ["\u{2212}500", "0", "500"]);
        assert_eq!(labels(700_000.0, 700_000.3, 3).last().unwrap(), "700000.3");
    }

    #[test]
    fn ranges_without_extent_get_one_mark() {
        assert_eq!(labels(3.0, 3.0, 5), ["3"]);
        assert_eq!(ticks(1.0, 1.0 + f64::EPSILON, 5).values.len(), 1);
    }
}
