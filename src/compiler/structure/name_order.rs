//! The order of variables where nothing else decides: by their names. The order of declarations must not
//! matter, so that a model whose lines are in another order has the same states and the same start.

use std::cmp::Ordering;

/// Compares names: those of outer components precede those inside of them, and numbers are compared by their value, so that
/// `x[2]` precedes `x[10]`.
pub fn compare(a: &str, b: &str) -> Ordering {
    let depth = |name: &str| name.bytes().filter(|c| *c == b'.').count();
    depth(a).cmp(&depth(b)).then_with(|| compare_text(a, b))
}

fn compare_text(a: &str, b: &str) -> Ordering {
    let (mut a, mut b) = (a.as_bytes(), b.as_bytes());
    loop {
        let same = a.iter().zip(b).take_while(|(x, y)| x == y && !x.is_ascii_digit()).count();
        (a, b) = (&a[same..], &b[same..]);
        let (x, y) = (digits(a), digits(b));
        if x == 0 || y == 0 {
            return a.cmp(b);
        }
        let (m, n) = (without_zeros(&a[..x]), without_zeros(&b[..y]));
        let order = m.len().cmp(&n.len()).then_with(|| m.cmp(n)).then(x.cmp(&y));
        if order.is_ne() {
            return order;
        }
        (a, b) = (&a[x..], &b[y..]);
    }
}

/// Digits without leading zeros.
fn without_zeros(digits: &[u8]) -> &[u8] {
    &digits[digits.iter().take_while(|d| **d == b'0').count()..]
}

/// The number of digits at the start.
fn digits(text: &[u8]) -> usize {
    text.iter().take_while(|c| c.is_ascii_digit()).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outer_names_come_first_and_numbers_are_compared_by_their_value() {
        let mut names =
            ["x[10]", "x[2]", "a.b", "x", "a", "x[2,10]", "x[2,9]", "J2.w", "J10.w", "x[02]"];
        names.sort_by(|a, b| compare(a, b));
        let sorted =
            ["a", "x", "x[2,9]", "x[2,10]", "x[2]", "x[02]", "x[10]", "J2.w", "J10.w", "a.b"];
        assert_eq!(names, sorted);
    }
}
