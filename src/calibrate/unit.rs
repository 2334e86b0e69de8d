//! Units of recordings by name, with their conversion to SI units.

use crate::units::dimension::Dimension;
use crate::units::unit::{self, Counted, counted, is_a_turn_apart};

/// A value in SI units is `factor * value + offset`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Unit {
    /// SI units per unit.
    pub factor: f64,
    /// Its zero in SI units.
    pub offset: f64,
    /// What it measures.
    pub dimension: Dimension,
    /// What it counts, if it is a rate and says so.
    pub counted: Option<Counted>,
}

/// How a unit differs from that of a variable.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Mismatch {
    /// It measures something else.
    Dimension,
    /// One counts events, the other measures an angle.
    Turn,
}

/// Names and factors. Gauge pressures are relative to ambient.
const UNITS: [(&str, f64); 59] = [
    ("1", 1.0),
    ("%", 1e-2),
    ("Pa", 1.0),
    ("hPa", 1e2),
    ("kPa", 1e3),
    ("MPa", 1e6),
    ("mbar", 1e2),
    ("bar", 1e5),
    ("mbar gauge", 1e2),
    ("bar gauge", 1e5),
    ("psi", 6_894.757_293_168),
    ("m", 1.0),
    ("cm", 1e-2),
    ("mm", 1e-3),
    ("um", 1e-6),
    ("µm", 1e-6),
    ("nm", 1e-9),
    ("m2", 1.0),
    ("cm2", 1e-4),
    ("mm2", 1e-6),
    ("m3", 1.0),
    ("l", 1e-3),
    ("ml", 1e-6),
    ("cm3", 1e-6),
    ("mm3", 1e-9),
    ("s", 1.0),
    ("ms", 1e-3),
    ("us", 1e-6),
    ("µs", 1e-6),
    ("min", 60.0),
    ("h", 3600.0),
    ("d", 86_400.0),
    ("Hz", 1.0),
    ("kHz", 1e3),
    ("rad", 1.0),
    ("deg", std::f64::consts::PI / 180.0),
    ("rad/s", 1.0),
    ("rpm", std::f64::consts::PI / 30.0),
    ("m/s", 1.0),
    ("mm/s", 1e-3),
    ("m/s2", 1.0),
    ("kg", 1.0),
    ("g", 1e-3),
    ("kg/s", 1.0),
    ("g/s", 1e-3),
    ("N", 1.0),
    ("mN", 1e-3),
    ("kN", 1e3),
    ("N.m", 1.0),
    ("Nm", 1.0),
    ("W", 1.0),
    ("J", 1.0),
    ("V", 1.0),
    ("mV", 1e-3),
    ("A", 1.0),
    ("mA", 1e-3),
    ("K", 1.0),
    ("m3/s", 1.0),
    ("l/min", 1e-3 / 60.0),
];

impl Unit {
    /// The second.
    pub const SECOND: Unit =
        Unit { factor: 1.0, offset: 0.0, dimension: Dimension::TIME, counted: None };

    /// The unit of this name: one of [`Unit::names`], or an expression of units as models write them, such as `mol/l`.
    pub fn of(name: &str) -> Option<Unit> {
        Unit::of_common(name).or_else(|| {
            let found = modelica(name.trim()).filter(|_| !name.trim().is_empty())?;
            let scale = found.scale?;
            let dimension = found.dimension;
            let (factor, offset, counted) = (scale.factor, scale.offset, counted(name.trim()));
            Some(Unit { factor, offset, dimension, counted })
        })
    }

    /// The unit of one of [`Unit::names`]: where any text may end a name, `_T` is no tesla.
    pub fn of_common(name: &str) -> Option<Unit> {
        let name = name.trim();
        if matches!(name, "degC" | "°C") {
            let dimension = Dimension::TEMPERATURE;
            return Some(Unit { factor: 1.0, offset: 273.15, dimension, counted: None });
        }
        let plain = name.replace('_', " ").replace('^', "");
        let (_, factor) = UNITS.iter().find(|(n, _)| *n == plain)?;
        let pressure = plain.trim_end_matches(" gauge");
        let (dimension, counted) = (modelica(pressure)?.dimension, counted(&plain));
        Some(Unit { factor: *factor, offset: 0.0, dimension, counted })
    }

    /// All names.
    pub fn names() -> impl Iterator<Item = &'static str> {
        UNITS.iter().map(|(n, _)| *n).chain(["degC"])
    }

    /// How it differs from the unit that a variable declares; `None` also if that is unknown or missing.
    pub fn mismatch(self, declared: &str) -> Option<Mismatch> {
        let own = unit::Unit::of(declared).filter(|_| !declared.is_empty())?;
        if own.dimension != self.dimension {
            return Some(Mismatch::Dimension);
        }
        is_a_turn_apart(self.counted, counted(declared)).then_some(Mismatch::Turn)
    }

    /// A value in SI units.
    pub fn to_si(self, value: f64) -> f64 {
        self.factor * value + self.offset
    }

    /// A value in this unit, from SI units.
    pub fn of_si(self, value: f64) -> f64 {
        (value - self.offset) / self.factor
    }
}

/// The unit as Modelica writes it.
fn modelica(name: &str) -> Option<unit::Unit> {
    let name = name.replace('µ', "u");
    unit::Unit::of(if name == "Nm" { "N.m" } else { &name })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_those_of_the_units_of_models() {
        for (name, factor) in UNITS {
            let name = name.trim_end_matches(" gauge");
            let scale = modelica(name).and_then(|u| u.scale).expect(name);
            assert!((scale.factor / factor - 1.0).abs() < 1e-9, "{name}");
        }
    }

    #[test]
    fn units_are_converted_by_name() {
        let si = |value, name| Unit::of(name).map(|u| u.to_si(value));
        assert_eq!(si(6.0, "bar"), Some(6e5));
        assert_eq!(si(6.0, "bar_gauge"), Some(6e5));
        assert_eq!(si(3.5, "mm"), Some(3.5e-3));
        assert_eq!(si(20.0, "degC"), Some(293.15));
        assert_eq!(si(60.0, "l/min"), Some(1e-3));
        assert_eq!(si(3.0, "mol/l"), Some(3e3));
        assert_eq!(si(2.0, "kg.m2"), Some(2.0));
        assert_eq!(si(1.0, "kOhm"), Some(1e3));
        assert_eq!(si(1.0, "furlong"), None);
        assert_eq!(si(1.0, "mm gauge"), None);
        assert_eq!(si(1.0, ""), None);
        assert_eq!(Unit::of("°C").map(|u| u.of_si(273.15)), Some(0.0));
    }

    #[test]
    fn events_over_time_are_no_speeds() {
        let of = |name, declared| Unit::of(name).unwrap().mismatch(declared);
        for counts in ["Hz", "kHz", "1/min"] {
            assert_eq!(of(counts, "rad/s"), Some(Mismatch::Turn), "{counts}");
            assert_eq!(of(counts, "Hz"), None, "{counts}");
        }
        for speed in ["rad/s", "rpm", "rev/s", "deg/s"] {
            assert_eq!(of(speed, "Hz"), Some(Mismatch::Turn), "{speed}");
            assert_eq!(of(speed, "rad/s"), None, "{speed}");
        }
        // Also written for either.
        assert_eq!((of("1/s", "rad/s"), of("1/s", "Hz"), of("rad/s", "1/s")), (None, None, None));
        assert_eq!(of("bar", "m"), Some(Mismatch::Dimension));
        assert_eq!((of("bar", ""), of("bar", "furlong")), (None, None));
    }

    #[test]
    fn names_are_unique() {
        let names: Vec<&str> = Unit::names().collect();
        assert!(names.iter().enumerate().all(|(i, n)| !names[..i].contains(n)));
    }
}
