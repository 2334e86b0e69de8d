//! Units to dimensions: exponents of the SI base units.
//!
//! *In:* a unit expression such as `J/(kg.K)` (Modelica 3.6, section 19.1). Scales and offsets are
//! ignored: `bar` and `Pa` have the same dimension, and so do `degC` and `K`. Plane angles are
//! dimensionless.

/// Exponents of kg, m, s, A, K, mol and cd, in twelfths, so that roots stay exact.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Dimension([i32; 7]);

/// Denominator of the exponents.
const PARTS: i32 = 12;
/// Symbols of the base units.
const BASE: [&str; 7] = ["kg", "m", "s", "A", "K", "mol", "cd"];

/// Symbols with their exponents of kg, m, s, A, K, mol, cd (SI Brochure, 9th ed. 2019, tables 2, 4
/// and 8).
const SYMBOLS: [(&str, [i32; 7]); 55] = [
    ("g", [1, 0, 0, 0, 0, 0, 0]),
    ("m", [0, 1, 0, 0, 0, 0, 0]),
    ("s", [0, 0, 1, 0, 0, 0, 0]),
    ("A", [0, 0, 0, 1, 0, 0, 0]),
    ("K", [0, 0, 0, 0, 1, 0, 0]),
    ("mol", [0, 0, 0, 0, 0, 1, 0]),
    ("cd", [0, 0, 0, 0, 0, 0, 1]),
    ("rad", [0; 7]),
    ("sr", [0; 7]),
    ("deg", [0; 7]),
    ("rev", [0; 7]),
    ("Hz", [0, 0, -1, 0, 0, 0, 0]),
    ("rpm", [0, 0, -1, 0, 0, 0, 0]),
    ("N", [1, 1, -2, 0, 0, 0, 0]),
    ("Pa", [1, -1, -2, 0, 0, 0, 0]),
    ("bar", [1, -1, -2, 0, 0, 0, 0]),
    ("psi", [1, -1, -2, 0, 0, 0, 0]),
    ("atm", [1, -1, -2, 0, 0, 0, 0]),
    ("J", [1, 2, -2, 0, 0, 0, 0]),
    ("eV", [1, 2, -2, 0, 0, 0, 0]),
    ("cal", [1, 2, -2, 0, 0, 0, 0]),
    ("W", [1, 2, -3, 0, 0, 0, 0]),
    ("var", [1, 2, -3, 0, 0, 0, 0]),
    ("hp", [1, 2, -3, 0, 0, 0, 0]),
    ("C", [0, 0, 1, 1, 0, 0, 0]),
    ("V", [1, 2, -3, -1, 0, 0, 0]),
    ("F", [-1, -2, 4, 2, 0, 0, 0]),
    ("Ohm", [1, 2, -3, -2, 0, 0, 0]),
    ("ohm", [1, 2, -3, -2, 0, 0, 0]),
    ("S", [-1, -2, 3, 2, 0, 0, 0]),
    ("Wb", [1, 2, -2, -1, 0, 0, 0]),
    ("T", [1, 0, -2, -1, 0, 0, 0]),
    ("H", [1, 2, -2, -2, 0, 0, 0]),
    ("degC", [0, 0, 0, 0, 1, 0, 0]),
    ("degF", [0, 0, 0, 0, 1, 0, 0]),
    ("degR", [0, 0, 0, 0, 1, 0, 0]),
    ("lm", [0, 0, 0, 0, 0, 0, 1]),
    ("lx", [0, -2, 0, 0, 0, 0, 1]),
    ("Bq", [0, 0, -1, 0, 0, 0, 0]),
    ("Gy", [0, 2, -2, 0, 0, 0, 0]),
    ("Sv", [0, 2, -2, 0, 0, 0, 0]),
    ("kat", [0, 0, -1, 0, 0, 1, 0]),
    ("min", [0, 0, 1, 0, 0, 0, 0]),
    ("h", [0, 0, 1, 0, 0, 0, 0]),
    ("d", [0, 0, 1, 0, 0, 0, 0]),
    ("l", [0, 3, 0, 0, 0, 0, 0]),
    ("L", [0, 3, 0, 0, 0, 0, 0]),
    ("t", [1, 0, 0, 0, 0, 0, 0]),
    ("lb", [1, 0, 0, 0, 0, 0, 0]),
    ("in", [0, 1, 0, 0, 0, 0, 0]),
    ("ft", [0, 1, 0, 0, 0, 0, 0]),
    ("kn", [0, 1, -1, 0, 0, 0, 0]),
    ("ha", [0, 2, 0, 0, 0, 0, 0]),
    ("G", [1, 0, -2, -1, 0, 0, 0]),
    ("u", [1, 0, 0, 0, 0, 0, 0]),
];

/// Names of dimensions in messages; the first match is used.
const SHOWN: [&str; 17] = [
    "N", "Pa", "J", "W", "V", "Ohm", "C", "F", "H", "Wb", "T", "S", "m/s", "m/s2", "J/K", "W/K",
    "1/s",
];

/// Prefixes of symbols, longest first.
const PREFIXES: [&str; 21] = [
    "da", "Q", "R", "Y", "Z", "E", "P", "T", "G", "M", "k", "h", "d", "c", "m", "u", "n", "p", "f",
    "a", "z",
];

impl Dimension {
    /// The dimension of a number.
    pub const ONE: Dimension = Dimension([0; 7]);
    /// The dimension of time.
    pub const TIME: Dimension = Dimension([0, 0, PARTS, 0, 0, 0, 0]);

    /// The dimension of a unit; `None` if the unit is unknown.
    pub fn of(unit: &str) -> Option<Dimension> {
        let text: Vec<char> = unit.chars().filter(|c| !c.is_whitespace()).collect();
        if text.is_empty() {
            return Some(Dimension::ONE);
        }
        let mut parser = UnitParser { text: &text, at: 0 };
        let found = parser.quotient()?;
        (parser.at == text.len()).then_some(found)
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
        if let Some(name) = SHOWN.iter().find(|n| Dimension::of(n) == Some(*self)) {
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

struct UnitParser<'a> {
    text: &'a [char],
    at: usize,
}

impl UnitParser<'_> {
    fn next_is(&mut self, wanted: char) -> bool {
        let found = self.text.get(self.at) == Some(&wanted);
        self.at += usize::from(found);
        found
    }

    fn quotient(&mut self) -> Option<Dimension> {
        let mut found = self.product()?;
        while self.next_is('/') {
            found = found.over(self.factor()?);
        }
        Some(found)
    }

    fn product(&mut self) -> Option<Dimension> {
        let mut found = self.factor()?;
        while self.next_is('.') {
            found = found.times(self.factor()?);
        }
        Some(found)
    }

    fn factor(&mut self) -> Option<Dimension> {
        if self.next_is('(') {
            let inner = self.quotient()?;
            return self.next_is(')').then_some(inner);
        }
        let start = self.at;
        if self.next_is('1') || self.next_is('%') {
            return Some(Dimension::ONE);
        }
        while self.text.get(self.at).is_some_and(|c| c.is_alphabetic()) {
            self.at += 1;
        }
        let symbol: String = self.text[start..self.at].iter().collect();
        symbol_dimension(&symbol)?.power(self.exponent()?)
    }

    fn exponent(&mut self) -> Option<f64> {
        let rational = self.next_is('(');
        let sign = if self.next_is('-') {
            -1.0
        } else {
            self.next_is('+');
            1.0
        };
        let Some(above) = self.digits() else { return (!rational && sign > 0.0).then_some(1.0) };
        let below = if rational && self.next_is('/') { self.digits()? } else { 1.0 };
        if rational && !self.next_is(')') {
            return None;
        }
        Some(sign * above / below)
    }

    fn digits(&mut self) -> Option<f64> {
        let start = self.at;
        while self.text.get(self.at).is_some_and(char::is_ascii_digit) {
            self.at += 1;
        }
        let text: String = self.text[start..self.at].iter().collect();
        text.parse().ok()
    }
}

fn symbol_dimension(symbol: &str) -> Option<Dimension> {
    let plain = |s: &str| {
        SYMBOLS.iter().find(|(n, _)| *n == s).map(|(_, e)| Dimension(e.map(|k| k * PARTS)))
    };
    plain(symbol).or_else(|| {
        PREFIXES.iter().find_map(|p| plain(symbol.strip_prefix(p).filter(|rest| !rest.is_empty())?))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_expressions_are_parsed() {
        let same = |a: &str, b: &str| {
            assert_eq!(Dimension::of(a), Dimension::of(b), "{a} and {b}");
            assert!(Dimension::of(a).is_some(), "{a}");
        };
        same("N", "kg.m/s2");
        same("Pa", "N/m2");
        same("J/(kg.K)", "m2.s-2.K-1");
        same("W/(m2.K)", "kg/(s3.K)");
        same("bar", "hPa");
        same("kW.h", "MJ");
        same("rad/s", "1/s");
        same("V.s(1/2)", "V.s(2/4)");
        same("mmol", "mol");
        same("min", "s");
        same("", "1");
        assert_eq!(Dimension::of("furlong"), None);
        assert_eq!(Dimension::of("m/"), None);
        assert_ne!(Dimension::of("N"), Dimension::of("N.m"));
    }

    #[test]
    fn dimensions_are_shown_by_known_names() {
        let shown = |unit: &str| Dimension::of(unit).map(|d| d.to_string()).unwrap_or_default();
        assert_eq!(shown("kg.m/s2"), "N");
        assert_eq!(shown("mm3"), "m3");
        assert_eq!(shown("J/(kg.K)"), "m2/(s2.K)");
        assert_eq!(shown("rad"), "1");
        assert_eq!(shown("1/m"), "1/m");
    }
}
