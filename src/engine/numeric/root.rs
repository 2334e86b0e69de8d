//! Locates a sign change of a function of one variable.
//!
//! I. F. D. Oliveira, R. H. C. Takahashi: *An enhancement of the bisection method average
//! performance preserving minmax optimality*, ACM Trans. Math. Software 47 (2020), art. 5 (the ITP
//! method): as fast as the secant method on smooth functions, and at most one step slower than
//! bisection, also across a jump.

/// An interval across which the function changes sign.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Bracket {
    /// The function has the sign of the given left end here, or is zero.
    pub left: f64,
    /// The function has strictly the sign of the given right end here: the sign has changed.
    pub right: f64,
    /// Value at `left`.
    pub value_left: f64,
    /// Value at `right`.
    pub value_right: f64,
    /// Evaluations of the function.
    pub evaluations: u32,
}

/// Why no bracket was found.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum NoRoot {
    /// The values at the ends do not have opposite signs (the left one may be zero).
    NoChange,
    /// The function is not a number here.
    NonFinite {
        /// Argument.
        at: f64,
    },
}

/// Shrinks `[a, b]` with values `fa`, `fb` until it is at most `tolerance` long, or until no double
/// lies inside. A zero counts as unchanged, so `right` lies beyond it.
pub fn locate(
    mut f: impl FnMut(f64) -> f64,
    (a, fa): (f64, f64),
    (b, fb): (f64, f64),
    tolerance: f64,
) -> Result<Bracket, NoRoot> {
    if fa.is_nan() {
        return Err(NoRoot::NonFinite { at: a });
    }
    if fb.is_nan() {
        return Err(NoRoot::NonFinite { at: b });
    }
    let sign = fb.signum();
    if fb == 0.0 || !(fa * sign <= 0.0) || !(a < b) {
        return Err(NoRoot::NoChange);
    }
    let mut bracket =
        Bracket { left: a, right: b, value_left: fa, value_right: fb, evaluations: 0 };
    let tolerance = tolerance.max(0.0);
    let kappa = KAPPA / (b - a);
    // The number of bisections needed, plus one that the interpolation may use.
    let half_width =
        0.5 * tolerance.max(f64::EPSILON * a.abs().max(b.abs())).max(f64::MIN_POSITIVE);
    let most = ((b - a) / (2.0 * half_width)).log2().ceil().max(0.0) + SPARE;
    let mut step = 0.0;
    let mut landed = false;
    while bracket.right - bracket.left > tolerance {
        let reach = half_width * 2.0_f64.powf((most - step).min(1000.0));
        let Some(mut x) = inner_point(&bracket, kappa, reach) else { break };
        if landed {
            // The last argument was an exact root: the sign changes just beyond it.
            x = x.min((bracket.left + 0.5 * tolerance).max(bracket.left.next_up()));
        }
        let value = f(x);
        landed = value == 0.0 && !landed;
        bracket.evaluations += 1;
        step += 1.0;
        if value.is_nan() {
            return Err(NoRoot::NonFinite { at: x });
        }
        if value * sign > 0.0 {
            (bracket.right, bracket.value_right) = (x, value);
        } else {
            (bracket.left, bracket.value_left) = (x, value);
        }
    }
    Ok(bracket)
}

/// Truncation parameter of the paper (kappa_1 (b - a) with kappa_2 = 2).
const KAPPA: f64 = 0.2;
/// Slack of the paper, n_0.
const SPARE: f64 = 1.0;

/// The next argument: interpolate, truncate towards the middle, project into the window that keeps
/// bisection's guarantee. `None` if no double lies inside the bracket.
fn inner_point(bracket: &Bracket, kappa: f64, reach: f64) -> Option<f64> {
    let Bracket { left, right, value_left, value_right, .. } = *bracket;
    let middle = left + 0.5 * (right - left);
    if !(left < middle && middle < right) {
        return None;
    }
    let width = right - left;
    let secant = (value_right * left - value_left * right) / (value_right - value_left);
    let secant = if secant.is_finite() { secant } else { middle };
    let towards = (middle - secant).signum();
    let truncation = kappa * width * width;
    let truncated =
        if truncation <= (middle - secant).abs() { secant + towards * truncation } else { middle };
    let radius = (reach - 0.5 * width).max(0.0);
    let projected =
        if (truncated - middle).abs() <= radius { truncated } else { middle - towards * radius };
    // An interpolation that rounds to an end would not shrink the bracket.
    Some(if left < projected && projected < right { projected } else { middle })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn find(f: impl Fn(f64) -> f64, a: f64, b: f64, tolerance: f64) -> Bracket {
        let (fa, fb) = (f(a), f(b));
        locate(f, (a, fa), (b, fb), tolerance).unwrap()
    }

    #[test]
    fn brackets_known_roots() {
        type RootCase = (fn(f64) -> f64, f64, f64, f64);
        let cases: [RootCase; 5] = [
            (|x| x * x - 2.0, 0.0, 2.0, 2.0_f64.sqrt()),
            (|x| 2.0 - x * x, 0.0, 2.0, 2.0_f64.sqrt()),
            (f64::cos, 1.0, 2.0, std::f64::consts::FRAC_PI_2),
            (|x| (x - 1.0).powi(9), 0.0, 1.7, 1.0),
            (|x| (-x).exp() - 1e-10, 0.0, 100.0, 1e10_f64.ln()),
        ];
        for (f, a, b, root) in cases {
            let bracket = find(f, a, b, 1e-12);
            assert!(bracket.right - bracket.left <= 1e-12);
            assert!(bracket.left <= root + 1e-15 && root <= bracket.right, "{bracket:?} {root}");
            assert!(f(bracket.right) * f(b) > 0.0, "the right side has changed");
            assert!(f(bracket.left) * f(b) <= 0.0);
        }
    }

    #[test]
    fn smooth_roots_are_cheap_and_jumps_cost_no_more_than_bisection() {
        let smooth = find(|x| x.exp() - 2.0, 0.0, 2.0, 1e-12);
        assert!(smooth.evaluations <= 12, "{smooth:?}");
        let jump = find(|x| if x < 0.3 { -1e-9 } else { 1e9 }, 0.0, 1.0, 1e-12);
        assert!(jump.evaluations <= 42, "{jump:?}");
        assert!(jump.left < 0.3 && 0.3 <= jump.right);
    }

    #[test]
    fn a_tolerance_of_zero_ends_at_neighbouring_doubles() {
        let bracket = find(|x| x - 0.1, 0.0, 1.0, 0.0);
        assert_eq!(bracket.left, 0.1);
        assert_eq!(bracket.right, 0.1_f64.next_up());
    }

    /// The zero itself is not a change of sign: a relation `x > 0` must have switched at the right.
    #[test]
    fn a_zero_belongs_to_the_left() {
        let bracket = find(|x| x - 0.5, 0.0, 1.0, 1e-3);
        assert!(bracket.value_right > 0.0 && bracket.value_left <= 0.0);
        let from_zero = locate(|x| x, (0.0, 0.0), (1.0, 1.0), 1e-9).unwrap();
        assert!(from_zero.value_right > 0.0 && from_zero.right <= 1e-9);
    }

    #[test]
    fn rejects_intervals_without_a_sign_change() {
        assert_eq!(locate(|x| x, (1.0, 1.0), (2.0, 2.0), 1e-6), Err(NoRoot::NoChange));
        assert_eq!(locate(|x| x, (-1.0, -1.0), (0.0, 0.0), 1e-6), Err(NoRoot::NoChange));
        let nan = locate(|_| f64::NAN, (0.0, -1.0), (1.0, 1.0), 1e-6);
        assert!(matches!(nan, Err(NoRoot::NonFinite { .. })));
    }
}
