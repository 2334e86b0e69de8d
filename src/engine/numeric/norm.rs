//! Weighted norms: a deviation is measured in units of the tolerance of its component.
//!
//! Hairer, Nørsett & Wanner, *Solving Ordinary Differential Equations I*, sec. II.4, eq. (4.11).

/// Root mean square of `v[i] * weights[i]`, where a weight is one over the tolerated deviation.
///
/// Zero for empty vectors; not finite if any entry is not, so one test of the norm covers all.
pub fn weighted_rms(v: &[f64], weights: &[f64]) -> f64 {
    if v.is_empty() {
        return 0.0;
    }
    (weighted_square_sum(v, weights) / v.len() as f64).sqrt()
}

/// Sum of `(v[i] * weights[i])^2`.
#[inline]
pub fn weighted_square_sum(v: &[f64], weights: &[f64]) -> f64 {
    v.iter().zip(weights).map(|(v, w)| (v * w) * (v * w)).sum()
}

/// Largest `|v[i]| * weights[i]`; NaN if any product is NaN.
pub fn weighted_max(v: &[f64], weights: &[f64]) -> f64 {
    let mut largest = 0.0_f64;
    for (v, w) in v.iter().zip(weights) {
        let size = v.abs() * w;
        // `!(a <= b)` also accepts a NaN, which the check below then returns.
        if !(size <= largest) {
            largest = size;
        }
        if largest.is_nan() {
            return largest;
        }
    }
    largest
}

/// The component that contributes most to a weighted norm: the first that is not finite, or else
/// the largest. `None` for empty vectors.
pub fn worst_component(v: &[f64], weights: &[f64]) -> Option<usize> {
    if let Some(i) = first_non_finite(v) {
        return Some(i);
    }
    let mut worst = None;
    let mut largest = -1.0;
    for (i, (v, w)) in v.iter().zip(weights).enumerate() {
        let size = v.abs() * w;
        if size > largest {
            largest = size;
            worst = Some(i);
        }
    }
    worst
}

/// The first entry that is infinite or NaN.
pub fn first_non_finite(v: &[f64]) -> Option<usize> {
    v.iter().position(|x| !x.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rms_of_three_four() {
        // sqrt((3^2 + 4^2) / 2)
        assert_eq!(weighted_rms(&[3.0, 2.0], &[1.0, 2.0]), 12.5_f64.sqrt());
        assert_eq!(weighted_rms(&[], &[]), 0.0);
    }

    #[test]
    fn a_nan_anywhere_is_detected() {
        for v in [[f64::NAN, 1.0, 2.0], [2.0, 1.0, f64::NAN]] {
            let w = [1.0; 3];
            assert!(weighted_rms(&v, &w).is_nan());
            assert!(weighted_max(&v, &w).is_nan());
        }
        assert_eq!(worst_component(&[1.0, 9.0, f64::NAN], &[1.0; 3]), Some(2));
        assert_eq!(worst_component(&[1.0, -9.0, 3.0], &[1.0, 1.0, 2.0]), Some(1));
        assert_eq!(worst_component(&[], &[]), None);
    }
}
