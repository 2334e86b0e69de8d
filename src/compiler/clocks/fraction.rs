//! Exact fractions: the periods and shifts of clocks.

use std::cmp::Ordering;

/// A fraction in lowest terms; the denominator is positive.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Fraction {
    numerator: i128,
    denominator: i128,
}

impl Fraction {
    pub const ZERO: Fraction = Fraction { numerator: 0, denominator: 1 };
    pub const ONE: Fraction = Fraction { numerator: 1, denominator: 1 };

    /// `numerator / denominator`, which is not zero. Products beyond 127 bits saturate.
    pub fn new(numerator: i128, denominator: i128) -> Fraction {
        let common = gcd(numerator, denominator).max(1);
        let sign = if denominator < 0 { -1 } else { 1 };
        Fraction {
            numerator: sign * numerator / common,
            denominator: (sign * denominator / common).max(1),
        }
    }

    /// The fraction with the smallest denominator that is this number to the last bit; `None` if it has more
    /// than nine digits.
    pub fn of_float(x: f64) -> Option<Fraction> {
        let (mut before, mut now) = ((0_i128, 1_i128), (1_i128, 0_i128));
        let mut rest = x;
        while rest.is_finite() && rest.abs() < 1e18 {
            let whole = rest.floor();
            let next = (whole as i128 * now.0 + before.0, whole as i128 * now.1 + before.1);
            (before, now) = (now, next);
            if now.1 > 1_000_000_000 {
                return None;
            }
            if now.0 as f64 / now.1 as f64 == x {
                return Some(Fraction::new(now.0, now.1));
            }
            rest = 1.0 / (rest - whole);
        }
        None
    }

    pub fn times(self, other: Fraction) -> Fraction {
        Fraction::new(
            self.numerator.saturating_mul(other.numerator),
            self.denominator.saturating_mul(other.denominator),
        )
    }

    /// The quotient; `other` is not zero.
    pub fn over(self, other: Fraction) -> Fraction {
        self.times(Fraction::new(other.denominator, other.numerator))
    }

    pub fn plus(self, other: Fraction) -> Fraction {
        let a = self.numerator.saturating_mul(other.denominator);
        let b = other.numerator.saturating_mul(self.denominator);
        Fraction::new(a.saturating_add(b), self.denominator.saturating_mul(other.denominator))
    }

    pub fn minus(self, other: Fraction) -> Fraction {
        self.plus(Fraction { numerator: -other.numerator, ..other })
    }

    /// The largest fraction of which both are multiples.
    pub fn common_divisor(self, other: Fraction) -> Fraction {
        let a = self.numerator.saturating_mul(other.denominator);
        let b = other.numerator.saturating_mul(self.denominator);
        Fraction::new(gcd(a, b), self.denominator.saturating_mul(other.denominator))
    }

    pub fn is_negative(self) -> bool {
        self.numerator < 0
    }

    pub fn is_zero(self) -> bool {
        self.numerator == 0
    }

    /// The whole number, if it is one.
    pub fn whole(self) -> Option<i64> {
        (self.denominator == 1).then(|| i64::try_from(self.numerator).ok())?
    }

    /// The nearest number.
    pub fn value(self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }
}

impl PartialOrd for Fraction {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.minus(*other).numerator.partial_cmp(&0)
    }
}

fn gcd(a: i128, b: i128) -> i128 {
    let (mut a, mut b) = (a.saturating_abs(), b.saturating_abs());
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

#[cfg(test)]
mod tests {
    use super::Fraction;

    #[test]
    fn fractions_are_exact() {
        let [a, b] = [Fraction::new(3, 10), Fraction::new(1, 4)];
        assert_eq!(a.plus(b), Fraction::new(11, 20));
        assert_eq!(a.minus(b), Fraction::new(1, 20));
        assert_eq!(a.over(b), Fraction::new(6, 5));
        assert_eq!(a.common_divisor(b), Fraction::new(1, 20));
        assert_eq!(Fraction::new(4, 2).whole(), Some(2));
        assert!(b < a && Fraction::new(-1, 2).is_negative());
    }

    #[test]
    fn decimals_have_small_denominators() {
        assert_eq!(Fraction::of_float(0.1), Some(Fraction::new(1, 10)));
        assert_eq!(Fraction::of_float(0.02), Some(Fraction::new(1, 50)));
        assert_eq!(Fraction::of_float(1.0 / 3.0), Some(Fraction::new(1, 3)));
        // The nearest double of pi is a fraction of nine digits, to the last bit.
        assert_eq!(
            Fraction::of_float(std::f64::consts::PI),
            Some(Fraction::new(245_850_922, 78_256_779))
        );
        assert_eq!(Fraction::of_float(1e-12 * std::f64::consts::PI), None);
    }
}
