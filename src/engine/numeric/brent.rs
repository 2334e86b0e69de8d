//! Brent's method for the maximum of a function of one variable in an interval.
//!
//! R. P. Brent: *Algorithms for Minimization without Derivatives*, Prentice-Hall 1973, chapter 5:
//! steps to the vertex of the parabola through the three best points, and golden-section steps
//! where the parabola is unreliable.

/// The golden section, `(3 - sqrt(5))/2`.
const GOLDEN: f64 = 0.381_966_011_250_105_1;
/// Maximum number of evaluations; parabolas need about eight.
const MAX_EVALUATIONS: u32 = 60;

/// Location, to `tolerance`, and value of a local maximum in `[a, b]`. NaN counts as minus
/// infinity.
pub fn maximum(mut f: impl FnMut(f64) -> f64, a: f64, b: f64, tolerance: f64) -> (f64, f64) {
    let (mut low, mut high) = (a, b);
    let mut negated = |x: f64| {
        let value = f(x);
        if value.is_nan() { f64::INFINITY } else { -value }
    };
    // The names are Brent's: x is the best point, w the second best, v the previous w.
    let mut x = low + GOLDEN * (high - low);
    let (mut w, mut v) = (x, x);
    let mut fx = negated(x);
    let (mut fw, mut fv) = (fx, fx);
    let (mut d, mut e) = (0.0_f64, 0.0_f64);
    for _ in 0..MAX_EVALUATIONS {
        let middle = 0.5 * (low + high);
        let t = tolerance.max(f64::EPSILON * x.abs());
        if (x - middle).abs() <= 2.0 * t - 0.5 * (high - low) {
            break;
        }
        let (mut p, mut q, mut r) = (0.0, 0.0, 0.0);
        if e.abs() > t {
            r = (x - w) * (fx - fv);
            q = (x - v) * (fx - fw);
            p = (x - v) * q - (x - w) * r;
            q = 2.0 * (q - r);
            if q > 0.0 {
                p = -p;
            } else {
                q = -q;
            }
            r = e;
            e = d;
        }
        if p.abs() < (0.5 * q * r).abs() && p > q * (low - x) && p < q * (high - x) {
            d = p / q;
            let u = x + d;
            if u - low < 2.0 * t || high - u < 2.0 * t {
                d = if x < middle { t } else { -t };
            }
        } else {
            e = if x < middle { high - x } else { low - x };
            d = GOLDEN * e;
        }
        let u = x + if d.abs() >= t { d } else { t * d.signum() };
        let fu = negated(u);
        if fu <= fx {
            if u < x {
                high = x
            } else {
                low = x
            }
            (v, fv, w, fw, x, fx) = (w, fw, x, fx, u, fu);
        } else {
            if u < x {
                low = u
            } else {
                high = u
            }
            if fu <= fw || w == x {
                (v, fv, w, fw) = (w, fw, u, fu);
            } else if fu <= fv || v == x || v == w {
                (v, fv) = (u, fu);
            }
        }
    }
    (x, -fx)
}

/// Location and value of the vertex of the parabola through three points with increasing abscissas;
/// `None` if the parabola has no maximum.
pub fn vertex(points: [(f64, f64); 3]) -> Option<(f64, f64)> {
    let [(a, fa), (b, fb), (c, fc)] = points;
    let left = (fb - fa) / (b - a);
    let right = (fc - fb) / (c - b);
    let curvature = (right - left) / (c - a);
    if !(curvature < 0.0) {
        return None;
    }
    // Newton's form: f = fa + left (x - a) + curvature (x - a) (x - b).
    let x = 0.5 * (a + b) - 0.5 * left / curvature;
    Some((x, fa + left * (x - a) + curvature * (x - a) * (x - b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Brent's own example, section 5.6: the minima between the poles of
    /// `sum ((2 i - 5)/(x - i^2))^2`.
    #[test]
    fn minima_of_brents_table() {
        let f = |x: f64| -> f64 {
            let term = |i: i32| {
                let i = f64::from(i);
                ((2.0 * i - 5.0) / (x - i * i)).powi(2)
            };
            -(1..=20).map(term).sum::<f64>()
        };
        let published = [(1.0, 3.022_915_3, 3.676_699_0), (2.0, 6.683_753_6, 1.111_850_1)];
        for (i, place, value) in published {
            let (i, next): (f64, f64) = (i, i + 1.0);
            let (x, found) = maximum(f, i * i + 1e-9, next * next - 1e-9, 1e-9);
            assert!((x - place).abs() < 1e-6, "{x} instead of {place}");
            assert!((-found - value).abs() < 1e-6, "{found} instead of {value}");
        }
    }

    #[test]
    fn a_parabola_takes_one_step() {
        let mut evaluations = 0;
        let f = |x: f64| {
            evaluations += 1;
            2.0 - (x - 0.3) * (x - 0.3)
        };
        let (x, value) = maximum(f, 0.0, 1.0, 1e-8);
        assert!((x - 0.3).abs() < 1e-7 && (value - 2.0).abs() < 1e-14);
        assert!(evaluations < 12, "{evaluations}");
        let (x, height) = vertex([(0.0, 1.91), (0.5, 1.96), (1.0, 1.51)]).unwrap();
        assert!((x - 0.3).abs() < 1e-12 && (height - 2.0).abs() < 1e-12);
        assert_eq!(vertex([(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)]), None);
    }

    #[test]
    fn a_maximum_at_an_end_is_found_there() {
        let (x, _) = maximum(|x| x, 0.0, 1.0, 1e-9);
        assert!(x > 1.0 - 1e-8);
    }
}
