//! Dimensions: exponents of the SI base units. Plane angles are dimensionless.

use super::unit::Unit;

/// Exponents of kg, m, s, A, K, mol and cd, in twelfths, so that roots stay exact.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Dimension([i32; 7]);

/// Denominator of the exponents.
const PARTS: i32 = 12;
/// Symbols of the base units.
const BASE: [&str; 7] = ["kg", "m", "s", "A", "K", "mol", "cd"];

/// Names of dimensions in messages; the first match is used.
const SHOWN: [&str; 17] = [
    "N", "Pa", "J", "W", "V", "Ohm", "C", "F", "H", "Wb", "T", "S", "m/s", "m/s2", "J/K", "W/K",
    "1/s",
];

impl Dimension {
    /// The dimension of a number.
    pub const ONE: Dimension = Dimension([0; 7]);
    /// The dimension of time.
    pub const TIME: Dimension = Dimension([0, 0, PARTS, 0, 0, 0, 0]);
    /// The dimension of temperature.
    pub const TEMPERATURE: Dimension = Dimension([0, 0, 0, 0, PARTS, 0, 0]);

    /// The dimension with these exponents of the base units.
    pub fn new(exponents: [i32; 7]) -> Dimension {
        Dimension(exponents.map(|k| k * PARTS))
    }

    /// The exponents of kg, m, s, A, K, mol and cd, if they are whole.
    pub fn exponents(self) -> Option<[i32; 7]> {
        self.0.iter().all(|part| part % PARTS == 0).then(|| self.0.map(|part| part / PARTS))
    }

    /// The dimension of a product.
    pub fn times(self, other: Dimension) -> Dimension {
        Dimension(std::array::from_fn(|k| self.0[k] + other.0[k]))
    }

    /// The dimension of a quotient.
    pub fn over(self, other: Dimension) -> Dimension {
        Dimension(std::array::from_fn(|k| self.0[k] - other.0[k]))
    }

    /// The dimension of a power; `None` if an exponent is not a multiple of 1/12.
    pub fn power(self, exponent: f64) -> Option<Dimension> {
        let mut out = [0; 7];
        for (to, from) in out.iter_mut().zip(self.0) {
            let exact = f64::from(from) * exponent;
            if (exact - exact.round()).abs() > 1e-9 || exact.abs() > 1e4 {
                return None;
            }
            *to = exact.round() as i32;
        }
        Some(Dimension(out))
    }
}

impl std::fmt::Display for Dimension {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if *self == Dimension::ONE {
            return f.write_str("1");
        }
        if let Some(name) = SHOWN.iter().find(|n| Unit::of(n).is_some_and(|u| u.dimension == *self))
        {
            return f.write_str(name);
        }
        let factors = |sign: i32| -> Vec<String> {
            (0..7)
                .filter(|k| self.0[*k] * sign > 0)
                .map(|k| match self.0[k].abs() {
                    PARTS => BASE[k].to_string(),
                    n if n % PARTS == 0 => format!("{}{}", BASE[k], n / PARTS),
                    n => format!("{}({n}/{PARTS})", BASE[k]),
                })
                .collect()
        };
        let (above, below) = (factors(1), factors(-1));
        let above = if above.is_empty() { "1".to_string() } else { above.join(".") };
        match below.as_slice() {
            [] => f.write_str(&above),
            [one] => write!(f, "{above}/{one}"),
            many => write!(f, "{above}/({})", many.join(".")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dimensions_are_shown_by_known_names() {
        let shown =
            |unit: &str| Unit::of(unit).map(|u| u.dimension.to_string()).unwrap_or_default();
        assert_eq!(shown("kg.m/s2"), "N");
        assert_eq!(shown("mm3"), "m3");
        assert_eq!(shown("J/(kg.K)"), "m2/(s2.K)");
        assert_eq!(shown("rad"), "1");
        assert_eq!(shown("1/m"), "1/m");
    }
}
