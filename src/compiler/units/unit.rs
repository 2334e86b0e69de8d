//! Unit expressions such as `J/(kg.K)` (Modelica 3.6, section 19.1): their dimension and scale.

use std::f64::consts::PI;

use super::dimension::Dimension;

/// A unit.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Unit {
    /// Its dimension.
    pub dimension: Dimension,
    /// Its size and zero; `None` for logarithmic units, which do not add like others.
    pub scale: Option<Scale>,
    /// What it measures, where units of one dimension are told apart by name.
    pub kind: Option<Kind>,
}

/// A value in SI units is `factor * value + offset`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Scale {
    /// SI units per unit.
    pub factor: f64,
    /// Its zero in SI units.
    pub offset: f64,
}

/// Quantities whose units have the same dimension, but are written differently.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Kind {
    /// Measured in `J`.
    Energy,
    /// Measured in `N.m`.
    Torque,
}

/// What the rate in a unit counts. `Hz` and `rad/s` have one dimension, but a turn lies between them.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Counted {
    /// How often something happens: `Hz`, `1/min`.
    Events,
    /// An angle or turns: `rad/s`, `deg`, `rpm`.
    Angle,
}

/// What the rate in a unit counts, if the unit says so. `1/s` does not: it is also written for `rad/s`.
pub fn counted(unit: &str) -> Option<Counted> {
    if symbols(unit).any(|symbol| symbol.ends_with("Hz")) {
        return Some(Counted::Events);
    }
    if symbols(unit).any(|symbol| ["rad", "mrad", "deg", "rev", "rpm"].contains(&symbol)) {
        return Some(Counted::Angle);
    }
    let per_time = Unit::ONE.over(Unit::si(Dimension::TIME)).dimension;
    let found = Unit::of(unit).filter(|u| u.dimension == per_time)?;
    found.scale.filter(|s| s.factor != 1.0).map(|_| Counted::Events)
}

/// Whether one unit counts events where the other measures an angle.
pub fn is_a_turn_apart(a: Option<Counted>, b: Option<Counted>) -> bool {
    a.is_some() && b.is_some() && a != b
}

/// The symbols of a unit with their prefixes, without exponents.
fn symbols(unit: &str) -> impl Iterator<Item = &str> {
    let parts = unit.split(|c: char| "./()".contains(c));
    parts.map(|part| part.trim_end_matches(|c: char| c.is_ascii_digit() || "+-^".contains(c)))
}

const ONE: [i32; 7] = [0; 7];

/// Symbols with their SI factors and exponents of kg, m, s, A, K, mol, cd (SI Brochure, 9th ed.
/// 2019, tables 2, 4 and 8; NIST Special Publication 811, 2008, appendix B).
const SYMBOLS: [(&str, f64, [i32; 7]); 57] = [
    ("g", 1e-3, [1, 0, 0, 0, 0, 0, 0]),
    ("m", 1.0, [0, 1, 0, 0, 0, 0, 0]),
    ("s", 1.0, [0, 0, 1, 0, 0, 0, 0]),
    ("A", 1.0, [0, 0, 0, 1, 0, 0, 0]),
    ("K", 1.0, [0, 0, 0, 0, 1, 0, 0]),
    ("mol", 1.0, [0, 0, 0, 0, 0, 1, 0]),
    ("cd", 1.0, [0, 0, 0, 0, 0, 0, 1]),
    ("rad", 1.0, ONE),
    ("sr", 1.0, ONE),
    ("deg", PI / 180.0, ONE),
    ("rev", 2.0 * PI, ONE),
    ("Hz", 1.0, [0, 0, -1, 0, 0, 0, 0]),
    ("rpm", PI / 30.0, [0, 0, -1, 0, 0, 0, 0]),
    ("N", 1.0, [1, 1, -2, 0, 0, 0, 0]),
    ("Pa", 1.0, [1, -1, -2, 0, 0, 0, 0]),
    ("bar", 1e5, [1, -1, -2, 0, 0, 0, 0]),
    ("psi", 6_894.757_293_168, [1, -1, -2, 0, 0, 0, 0]),
    ("atm", 101_325.0, [1, -1, -2, 0, 0, 0, 0]),
    ("J", 1.0, [1, 2, -2, 0, 0, 0, 0]),
    ("eV", 1.602_176_634e-19, [1, 2, -2, 0, 0, 0, 0]),
    ("cal", 4.184, [1, 2, -2, 0, 0, 0, 0]),
    ("W", 1.0, [1, 2, -3, 0, 0, 0, 0]),
    ("var", 1.0, [1, 2, -3, 0, 0, 0, 0]),
    ("hp", 745.699_871_582, [1, 2, -3, 0, 0, 0, 0]),
    ("C", 1.0, [0, 0, 1, 1, 0, 0, 0]),
    ("V", 1.0, [1, 2, -3, -1, 0, 0, 0]),
    ("F", 1.0, [-1, -2, 4, 2, 0, 0, 0]),
    ("Ohm", 1.0, [1, 2, -3, -2, 0, 0, 0]),
    ("ohm", 1.0, [1, 2, -3, -2, 0, 0, 0]),
    ("S", 1.0, [-1, -2, 3, 2, 0, 0, 0]),
    ("Wb", 1.0, [1, 2, -2, -1, 0, 0, 0]),
    ("T", 1.0, [1, 0, -2, -1, 0, 0, 0]),
    ("H", 1.0, [1, 2, -2, -2, 0, 0, 0]),
    ("degC", 1.0, [0, 0, 0, 0, 1, 0, 0]),
    ("degF", 5.0 / 9.0, [0, 0, 0, 0, 1, 0, 0]),
    ("degR", 5.0 / 9.0, [0, 0, 0, 0, 1, 0, 0]),
    ("degRk", 5.0 / 9.0, [0, 0, 0, 0, 1, 0, 0]),
    ("lm", 1.0, [0, 0, 0, 0, 0, 0, 1]),
    ("lx", 1.0, [0, -2, 0, 0, 0, 0, 1]),
    ("Bq", 1.0, [0, 0, -1, 0, 0, 0, 0]),
    ("Gy", 1.0, [0, 2, -2, 0, 0, 0, 0]),
    ("Sv", 1.0, [0, 2, -2, 0, 0, 0, 0]),
    ("kat", 1.0, [0, 0, -1, 0, 0, 1, 0]),
    ("min", 60.0, [0, 0, 1, 0, 0, 0, 0]),
    ("h", 3600.0, [0, 0, 1, 0, 0, 0, 0]),
    ("d", 86_400.0, [0, 0, 1, 0, 0, 0, 0]),
    ("l", 1e-3, [0, 3, 0, 0, 0, 0, 0]),
    ("L", 1e-3, [0, 3, 0, 0, 0, 0, 0]),
    ("t", 1e3, [1, 0, 0, 0, 0, 0, 0]),
    ("lb", 0.453_592_37, [1, 0, 0, 0, 0, 0, 0]),
    ("in", 0.0254, [0, 1, 0, 0, 0, 0, 0]),
    ("ft", 0.3048, [0, 1, 0, 0, 0, 0, 0]),
    ("kn", 1852.0 / 3600.0, [0, 1, -1, 0, 0, 0, 0]),
    ("ha", 1e4, [0, 2, 0, 0, 0, 0, 0]),
    ("G", 1e-4, [1, 0, -2, -1, 0, 0, 0]),
    ("u", 1.660_539_066_6e-27, [1, 0, 0, 0, 0, 0, 0]),
    ("ppm", 1e-6, ONE),
];

/// Symbols of logarithmic units.
const LOGARITHMIC: [&str; 5] = ["dB", "B", "Np", "phon", "sone"];

/// Zeros of temperature scales, in K.
const ZEROS: [(&str, f64); 2] = [("degC", 273.15), ("degF", 459.67 * 5.0 / 9.0)];

/// Prefixes of symbols, longest first.
const PREFIXES: [(&str, f64); 21] = [
    ("da", 1e1),
    ("Q", 1e30),
    ("R", 1e27),
    ("Y", 1e24),
    ("Z", 1e21),
    ("E", 1e18),
    ("P", 1e15),
    ("T", 1e12),
    ("G", 1e9),
    ("M", 1e6),
    ("k", 1e3),
    ("h", 1e2),
    ("d", 1e-1),
    ("c", 1e-2),
    ("m", 1e-3),
    ("u", 1e-6),
    ("n", 1e-9),
    ("p", 1e-12),
    ("f", 1e-15),
    ("a", 1e-18),
    ("z", 1e-21),
];

impl Unit {
    /// The unit of numbers.
    pub const ONE: Unit = Unit::si(Dimension::ONE);

    /// The SI unit of a dimension.
    pub const fn si(dimension: Dimension) -> Unit {
        Unit { dimension, scale: Some(Scale { factor: 1.0, offset: 0.0 }), kind: None }
    }

    /// The unit of an expression; `None` if a symbol is unknown or the syntax is wrong.
    pub fn of(expression: &str) -> Option<Unit> {
        let text: Vec<char> = expression.chars().filter(|c| !c.is_whitespace()).collect();
        if text.is_empty() {
            return Some(Unit::ONE);
        }
        let compact: String = text.iter().collect();
        if let Some((_, zero)) = ZEROS.iter().find(|(name, _)| *name == compact) {
            let mut found = symbol(&compact)?;
            found.scale = found.scale.map(|s| Scale { offset: *zero, ..s });
            return Some(found);
        }
        let mut parser = UnitParser { text: &text, at: 0 };
        let found = parser.quotient()?;
        (parser.at == text.len()).then_some(Unit { kind: kind(&compact, found), ..found })
    }

    /// The symbols of units, without prefixes.
    pub fn symbols() -> impl Iterator<Item = &'static str> {
        SYMBOLS.iter().map(|(name, ..)| *name)
    }

    /// The unit of a product. Products of temperatures are products of differences.
    pub fn times(self, other: Unit) -> Unit {
        self.combined(self.dimension.times(other.dimension), other, |a, b| a * b)
    }

    /// The unit of a quotient.
    pub fn over(self, other: Unit) -> Unit {
        self.combined(self.dimension.over(other.dimension), other, |a, b| a / b)
    }

    fn combined(self, dimension: Dimension, other: Unit, of: fn(f64, f64) -> f64) -> Unit {
        let scale = self.scale.zip(other.scale);
        let scale = scale.map(|(a, b)| Scale { factor: of(a.factor, b.factor), offset: 0.0 });
        Unit { dimension, scale, kind: None }
    }

    /// The unit of a power; `None` if an exponent is not a multiple of 1/12.
    pub fn power(self, exponent: f64) -> Option<Unit> {
        let dimension = self.dimension.power(exponent)?;
        let scale = self.scale.map(|s| Scale { factor: s.factor.powf(exponent), offset: 0.0 });
        let kind = if exponent == 1.0 { self.kind } else { None };
        Some(Unit { dimension, scale, kind })
    }
}

impl Scale {
    /// True if units of both scales have the same size.
    pub fn is_of_size(self, other: Scale) -> bool {
        (self.factor / other.factor - 1.0).abs() < 1e-9
    }

    /// True if values of both scales are equal.
    pub fn is_same(self, other: Scale) -> bool {
        self.is_of_size(other) && (self.offset - other.offset).abs() < 1e-6
    }
}

/// Energies are written in joules, torques in newton metres.
fn kind(expression: &str, unit: Unit) -> Option<Kind> {
    if unit.dimension != Dimension::new([1, 2, -2, 0, 0, 0, 0]) || expression.contains('/') {
        return None;
    }
    match expression.split_once('.') {
        None => expression.ends_with('J').then_some(Kind::Energy),
        Some((force, arm)) => (force.ends_with('N') && arm.ends_with('m')).then_some(Kind::Torque),
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

    fn quotient(&mut self) -> Option<Unit> {
        let mut found = self.product()?;
        while self.next_is('/') {
            found = found.over(self.factor()?);
        }
        Some(found)
    }

    fn product(&mut self) -> Option<Unit> {
        let mut found = self.factor()?;
        while self.next_is('.') {
            found = found.times(self.factor()?);
        }
        Some(found)
    }

    fn factor(&mut self) -> Option<Unit> {
        if self.next_is('(') {
            let inner = self.quotient()?;
            return self.next_is(')').then_some(inner);
        }
        let start = self.at;
        if self.next_is('1') {
            return Some(Unit::ONE);
        }
        if self.next_is('%') {
            let scale = Some(Scale { factor: 1e-2, offset: 0.0 });
            return Some(Unit { scale, ..Unit::ONE });
        }
        while self.text.get(self.at).is_some_and(|c| c.is_alphabetic()) {
            self.at += 1;
        }
        let name: String = self.text[start..self.at].iter().collect();
        symbol(&name)?.power(self.exponent()?)
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

fn symbol(name: &str) -> Option<Unit> {
    if LOGARITHMIC.contains(&name) {
        return Some(Unit { scale: None, ..Unit::ONE });
    }
    let plain = |s: &str, prefix: f64| {
        let (_, factor, exponents) = SYMBOLS.iter().find(|(n, ..)| *n == s)?;
        let scale = Some(Scale { factor: prefix * factor, offset: 0.0 });
        Some(Unit { dimension: Dimension::new(*exponents), scale, kind: None })
    };
    plain(name, 1.0).or_else(|| {
        PREFIXES.iter().find_map(|(prefix, factor)| {
            plain(name.strip_prefix(prefix).filter(|rest| !rest.is_empty())?, *factor)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factor(unit: &str) -> f64 {
        Unit::of(unit).and_then(|u| u.scale).map_or(f64::NAN, |s| s.factor)
    }

    #[test]
    fn unit_expressions_are_parsed() {
        let same = |a: &str, b: &str| {
            let [x, y] = [a, b].map(|u| Unit::of(u).map(|u| u.dimension));
            assert_eq!(x, y, "{a} and {b}");
            assert!(x.is_some(), "{a}");
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
        assert_eq!(Unit::of("furlong"), None);
        assert_eq!(Unit::of("m/"), None);
        assert_ne!(Unit::of("N"), Unit::of("N.m"));
    }

    /// NIST Special Publication 811, 2008, appendix B.8.
    #[test]
    fn scales_are_those_of_the_tables() {
        let factors = [
            ("bar", 1e5),
            ("mm2", 1e-6),
            ("km/h", 1.0 / 3.6),
            ("kW.h", 3.6e6),
            ("rev/min", 0.104_719_755_119_659_77),
            ("l/min", 1e-3 / 60.0),
            ("lb/in", 17.857_967_322_834_646),
            ("g/cm3", 1e3),
            ("s-1", 1.0),
            ("%", 0.01),
        ];
        for (unit, expected) in factors {
            assert!((factor(unit) / expected - 1.0).abs() < 1e-9, "{unit}: {}", factor(unit));
        }
        let zero = |unit: &str| Unit::of(unit).and_then(|u| u.scale).map(|s| s.offset);
        assert_eq!(zero("degC"), Some(273.15));
        assert_eq!(zero("degC/s"), Some(0.0));
        // 32 degF is 0 degC.
        let fahrenheit = Unit::of("degF").and_then(|u| u.scale).expect("known");
        assert!((fahrenheit.factor * 32.0 + fahrenheit.offset - 273.15).abs() < 1e-9);
    }

    #[test]
    fn torques_are_not_energies() {
        let kind = |unit: &str| Unit::of(unit).and_then(|u| u.kind);
        assert_eq!(kind("kJ"), Some(Kind::Energy));
        assert_eq!(kind("kN.m"), Some(Kind::Torque));
        assert_eq!(kind("N.m/rad"), None);
        assert_eq!(kind("kg.m2/s2"), None);
    }
}
