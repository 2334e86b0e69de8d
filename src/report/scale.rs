//! Display units: converts SI values to units that engineers read, such as bar, mm, ms.

/// Conversion to a display unit: `shown = si / size - zero`.
#[derive(Clone, PartialEq, Debug)]
pub struct Scale {
    /// One display unit in SI units.
    pub size: f64,
    /// Offset of the zero, in display units: 273.15 for °C, otherwise 0.
    pub zero: f64,
    /// The printed unit, such as `m³/s` or `10⁻³ m²`; empty for plain numbers.
    pub unit: String,
}

impl Scale {
    /// The value in display units.
    pub fn shown(&self, si: f64) -> f64 {
        si / self.size - self.zero
    }
    fn of(size: f64, unit: &str) -> Self {
        Scale { size, zero: 0.0, unit: pretty(unit) }
    }
}

/// Chooses the display unit for values in the SI unit `unit`, the largest of magnitude `largest`. A
/// known `display_unit` is used as it is; without one the numbers are scaled to between 1 and 1000
/// if the unit allows.
pub fn choose(unit: &str, display_unit: &str, largest: f64) -> Scale {
    if let Some(scale) = declared(unit, display_unit) {
        return scale;
    }
    if let Some((_, _, shown, size)) =
        CUSTOMARY.iter().find(|(si, below, ..)| *si == unit && largest > 0.0 && largest < *below)
    {
        return Scale::of(*size, shown);
    }
    automatic(unit, largest)
}

/// The name of the quantity of an SI unit; empty if it is ambiguous.
pub fn quantity(unit: &str) -> &'static str {
    QUANTITIES.iter().find(|(si, _)| *si == unit).map_or("", |(_, name)| name)
}

/// The typeset unit: raised exponents, multiplication dots, symbols for degrees and ohm.
pub fn pretty(unit: &str) -> String {
    let word = |word: &str| match word {
        "1" => String::new(),
        "deg" => "°".to_owned(),
        "degC" => "°C".to_owned(),
        _ => word.replace("Ohm", "Ω").chars().map(printed).collect(),
    };
    let unit = match unit.strip_prefix('u') {
        Some(rest) if takes_prefix(rest) || rest == "s" => &format!("µ{rest}"),
        _ => unit,
    };
    match unit.split_once('/') {
        Some(("1", under)) => format!("1/{}", word(under)),
        _ => word(unit),
    }
}

/// Display units other than SI prefixes: (SI unit, display unit, size in SI, zero).
const CONVERSIONS: &[(&str, &str, f64, f64)] = &[
    ("Pa", "bar", 1e5, 0.0),
    ("Pa", "mbar", 1e2, 0.0),
    ("K", "degC", 1.0, 273.15),
    ("rad", "deg", std::f64::consts::PI / 180.0, 0.0),
    ("rad/s", "rpm", std::f64::consts::PI / 30.0, 0.0),
    ("rad/s", "rev/min", std::f64::consts::PI / 30.0, 0.0),
    ("rad/s", "1/min", std::f64::consts::PI / 30.0, 0.0),
    ("m/s", "km/h", 1.0 / 3.6, 0.0),
    ("m3", "l", 1e-3, 0.0),
    ("m3", "ml", 1e-6, 0.0),
    ("m3/s", "l/s", 1e-3, 0.0),
    ("m3/s", "l/min", 1e-3 / 60.0, 0.0),
    ("s", "min", 60.0, 0.0),
    ("s", "h", 3600.0, 0.0),
    ("s", "d", 86400.0, 0.0),
    ("J", "kWh", 3.6e6, 0.0),
    ("1", "%", 0.01, 0.0),
    ("", "%", 0.01, 0.0),
];

/// Customary units that take precedence over prefixes: (SI unit, bound of the largest magnitude,
/// display unit, its size). The first matching row applies.
const CUSTOMARY: &[(&str, f64, &str, f64)] = &[
    ("Pa", 1.0, "Pa", 1.0),
    ("Pa", 1e4, "mbar", 1e2),
    ("Pa", 1e8, "bar", 1e5),
    ("m2", 1e-2, "mm2", 1e-6),
    ("m3", 1e-7, "mm3", 1e-9),
    ("m3", 1e-3, "cm3", 1e-6),
    ("m3", 1.0, "l", 1e-3),
    ("s", 1e-6, "ns", 1e-9),
    ("s", 1e-3, "us", 1e-6),
    ("s", 1.0, "ms", 1e-3),
    ("s", 600.0, "s", 1.0),
    ("s", 7200.0, "min", 60.0),
    ("s", 259_200.0, "h", 3600.0),
    ("s", f64::INFINITY, "d", 86400.0),
];

const QUANTITIES: &[(&str, &str)] = &[
    ("s", "time"),
    ("m", "length"),
    ("m2", "area"),
    ("m3", "volume"),
    ("m/s", "velocity"),
    ("m/s2", "acceleration"),
    ("rad", "angle"),
    ("rad/s", "angular velocity"),
    ("kg", "mass"),
    ("kg/s", "mass flow"),
    ("m3/s", "volume flow"),
    ("kg/m3", "density"),
    ("N", "force"),
    ("N.m", "torque"),
    ("Pa", "pressure"),
    ("K", "temperature"),
    ("W", "power"),
    ("V", "voltage"),
    ("A", "current"),
    ("Ohm", "resistance"),
    ("Hz", "frequency"),
];

/// SI prefixes by exponent, without the uncommon `h` and `da`.
const PREFIXES: &[(i32, &str)] = &[
    (-12, "p"),
    (-9, "n"),
    (-6, "u"),
    (-3, "m"),
    (-2, "c"),
    (-1, "d"),
    (0, ""),
    (3, "k"),
    (6, "M"),
    (9, "G"),
];

/// Symbols that take a prefix at the start of a unit.
const PREFIXABLE: &[&str] =
    &["m", "g", "N", "Pa", "J", "W", "V", "A", "Ohm", "Hz", "F", "H", "T", "Wb", "C", "mol"];

/// The display unit declared by the model, if the conversion is known.
fn declared(unit: &str, display_unit: &str) -> Option<Scale> {
    if display_unit.is_empty() {
        return None;
    }
    if display_unit == unit {
        return Some(Scale::of(1.0, unit));
    }
    if let Some((_, _, size, zero)) =
        CONVERSIONS.iter().find(|(si, shown, ..)| *si == unit && *shown == display_unit)
    {
        return Some(Scale { zero: *zero, ..Scale::of(*size, display_unit) });
    }
    let (base, rest) = in_grams(unit);
    let power = power_of_first(rest);
    PREFIXES
        .iter()
        .find(|(_, prefix)| display_unit.strip_prefix(prefix) == Some(rest))
        .map(|(exponent, _)| Scale::of(10_f64.powi(exponent * power) / base, display_unit))
}

/// A prefix if the unit takes one, otherwise a power of ten in front of the unit.
fn automatic(unit: &str, largest: f64) -> Scale {
    let (base, rest) = in_grams(unit);
    if takes_prefix(rest) && power_of_first(rest) == 1 {
        // Units of mass take no larger prefix than the kilo of kg.
        let (own, top) = if base == 1.0 { (0, 9) } else { (3, 3) };
        let exponent = engineering_exponent(largest * base).unwrap_or(own).clamp(-12, top);
        let prefix = PREFIXES.iter().find(|(e, _)| *e == exponent).map_or("", |(_, p)| p);
        return Scale::of(10_f64.powi(exponent) / base, &format!("{prefix}{rest}"));
    }
    let readable = (1e-2..1e5).contains(&largest) || largest == 0.0;
    match engineering_exponent(largest).filter(|e| !readable && *e != 0) {
        None => Scale::of(1.0, unit),
        Some(exponent) => {
            let digits: String = exponent.to_string().chars().map(printed).collect();
            let unit = format!("10{digits} {}", pretty(unit)).trim_end().to_owned();
            Scale { size: 10_f64.powi(exponent), zero: 0.0, unit }
        }
    }
}

/// Replaces the kilogram, the only SI base unit with a prefix: (grams per SI unit, unit in grams).
fn in_grams(unit: &str) -> (f64, &str) {
    match unit.strip_prefix("kg") {
        Some(_) => (1e3, &unit[1..]),
        None => (1.0, unit),
    }
}

/// True if a unit starts with a symbol that takes a prefix.
fn takes_prefix(unit: &str) -> bool {
    let first = unit.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(unit.len());
    PREFIXABLE.contains(&&unit[..first])
}

/// The exponent of the first symbol of a unit: 2 for `m2/s`.
fn power_of_first(unit: &str) -> i32 {
    let rest = unit.trim_start_matches(|c: char| c.is_ascii_alphabetic());
    let digits = rest.find(|c: char| !c.is_ascii_digit() && c != '-').unwrap_or(rest.len());
    rest[..digits].parse().unwrap_or(1)
}

/// The multiple of three that scales `largest` to between 1 and 1000; `None` for zero.
fn engineering_exponent(largest: f64) -> Option<i32> {
    // A small tolerance, so that 0.001 counts as 1e-3.
    let power = (largest.abs().log10() + 1e-9).floor();
    power.is_finite().then(|| 3 * (power / 3.0).floor() as i32)
}

/// The typeset form of a character of a unit.
fn printed(c: char) -> char {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    match c {
        '-' => '⁻',
        '.' => '·',
        _ => c.to_digit(10).map_or(c, |d| RAISED[d as usize]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The shown number and unit of the largest value.
    fn shown(unit: &str, display_unit: &str, largest: f64) -> String {
        let scale = choose(unit, display_unit, largest);
        format!("{:.6} {}", scale.shown(largest), scale.unit)
    }

    #[test]
    fn automatic_units_are_the_customary_ones() {
        assert_eq!(shown("Pa", "", 700_000.0), "7.000000 bar");
        assert_eq!(shown("Pa", "", 250.0), "2.500000 mbar");
        assert_eq!(shown("Pa", "", 2.1e11), "210.000000 GPa");
        assert_eq!(shown("m", "", 3.5e-3), "3.500000 mm");
        assert_eq!(shown("m", "", 4e-6), "4.000000 µm");
        assert_eq!(shown("m", "", 2.0), "2.000000 m");
        assert_eq!(shown("m", "", 1e-3), "1.000000 mm");
        assert_eq!(shown("s", "", 0.12), "120.000000 ms");
        assert_eq!(shown("s", "", 5400.0), "90.000000 min");
        assert_eq!(shown("m/s", "", 0.4), "400.000000 mm/s");
        assert_eq!(shown("kg/s", "", 2.5e-4), "250.000000 mg/s");
        assert_eq!(shown("kg", "", 80.0), "80.000000 kg");
        assert_eq!(shown("kg", "", 8000.0), "8000.000000 kg");
        assert_eq!(shown("N.m", "", 12.0), "12.000000 N·m");
        assert_eq!(shown("m2", "", 7.85e-5), "78.500000 mm²");
        assert_eq!(shown("m3/s", "", 2e-4), "200.000000 10⁻⁶ m³/s");
        assert_eq!(shown("", "", 0.5), "0.500000 ");
        assert_eq!(shown("1", "", 2e-5), "20.000000 10⁻⁶");
        assert_eq!(shown("K", "", 293.15), "293.150000 K");
        assert_eq!(shown("m", "", 0.0), "0.000000 m");
        assert_eq!(shown("kg/s", "", 0.0), "0.000000 kg/s");
    }

    #[test]
    fn the_display_unit_of_the_model_takes_precedence() {
        assert_eq!(shown("Pa", "bar", 100.0), "0.001000 bar");
        assert_eq!(shown("Pa", "kPa", 700_000.0), "700.000000 kPa");
        assert_eq!(shown("Pa", "Pa", 700_000.0), "700000.000000 Pa");
        assert_eq!(shown("K", "degC", 293.15), "20.000000 °C");
        assert_eq!(shown("rad", "deg", std::f64::consts::PI), "180.000000 °");
        assert_eq!(shown("m/s", "km/h", 10.0), "36.000000 km/h");
        assert_eq!(shown("m3/s", "l/min", 1e-3), "60.000000 l/min");
        assert_eq!(shown("m2", "cm2", 1.0), "10000.000000 cm²");
        assert_eq!(shown("kg/s", "g/s", 2e-3), "2.000000 g/s");
        assert_eq!(shown("m", "mm", 2.0), "2000.000000 mm");
        // Unknown display units are ignored.
        assert_eq!(shown("m", "furlong", 2.0), "2.000000 m");
    }

    #[test]
    fn units_are_typeset() {
        assert_eq!(pretty("kg.m2/s3"), "kg·m²/s³");
        assert_eq!(pretty("s-1"), "s⁻¹");
        assert_eq!(pretty("1/s"), "1/s");
        assert_eq!(pretty("1"), "");
        assert_eq!(pretty("Ohm"), "Ω");
    }
}
