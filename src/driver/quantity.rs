//! Values with units, as users write them: `6 bar`, `12ms`, `20 degC`.

use crate::base::cause::causes;
use crate::base::diag::{did_you_mean, did_you_mean_or};
use crate::base::name::split_unquoted;
use crate::units::dimension::Dimension;
use crate::units::unit::{Scale, Unit, counted, is_a_turn_apart};

causes! {
    /// Causes found in values with units.
    pub enum QuantityCause {
        /// The unit of a value is unknown.
        error MO1410 UnknownUnit { setting: String, unit: String, near: Option<String> }
            => ("unknown unit `{unit}` in `{setting}`"),
            remedy(did_you_mean_or(
                near,
                "write a unit as in a model: `bar`, `mm`, `l/min`, `degC`; without one the value is in SI units",
            ));
        /// A value is relative to the ambient pressure, which only the model knows.
        error MO1419 Gauge { setting: String, gauge: String, absolute: String }
            => ("`{setting}` is relative to the ambient pressure, which the model decides"),
            help("write `{gauge}` if the parameter is a difference to the ambient pressure; if it is absolute, `{absolute}` \
                  at an ambient pressure of 1.01325 bar");
        /// The unit of a value cannot be converted to that of its parameter.
        error MO1411 WrongUnit { name: String, declared: String, unit: String }
            => ("cannot convert `{unit}` to `{declared}`, the unit of `{name}`"),
            help("give the value without a unit: it is then in `{declared}`");
    }
}

/// How a value in one unit becomes one in another.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Conversion {
    from: Scale,
    to: Scale,
}

impl Conversion {
    /// The value in the other unit.
    pub fn of(self, value: f64) -> f64 {
        (value * self.from.factor + self.from.offset - self.to.offset) / self.to.factor
    }
}

/// How a value in one unit becomes one in another. `None` if the units measure something else,
/// or one of them is unknown. A frequency in `Hz` and a speed in `rad/s` differ by a turn, which no unit says: they are
/// not converted.
pub fn conversion(source: &str, target: &str) -> Option<Conversion> {
    let (from, dimension) = scale_of(source)?;
    let (to, wanted) = scale_of(target)?;
    let confused = is_a_turn_apart(counted(source), counted(target));
    (dimension == wanted && !confused).then_some(Conversion { from, to })
}

/// A value with a unit.
#[derive(Clone, PartialEq, Debug)]
pub struct Quantity {
    /// In SI units.
    pub value: f64,
    /// The unit as written; empty without one.
    pub unit: String,
    /// What it measures.
    pub dimension: Dimension,
}

impl Quantity {
    /// A number without a unit.
    pub fn plain(value: f64) -> Quantity {
        Quantity { value, unit: String::new(), dimension: Dimension::ONE }
    }

    /// The value in a unit that a model declares; one without a unit is in that unit already. `None` if it cannot be
    /// converted.
    pub fn in_unit(&self, declared: &str) -> Option<f64> {
        if self.unit.is_empty() {
            return Some(self.value);
        }
        let (own, _) = scale_of(declared)?;
        conversion(&self.unit, declared).map(|_| tidy((self.value - own.offset) / own.factor))
    }
}

/// Reads a number, or a number with a unit.
pub fn read(text: &str) -> Option<Quantity> {
    let (number, unit) = split(text)?;
    let (scale, dimension) = scale_of(unit)?;
    let value = number.parse::<f64>().ok()? * scale.factor + scale.offset;
    Some(Quantity { value: tidy(value), unit: unit.to_owned(), dimension })
}

/// A setting with a unit.
pub(super) struct Given {
    /// The parameter.
    pub name: String,
    /// Its value.
    pub quantity: Quantity,
}

/// A setting `NAME=NUMBER UNIT` as one in SI units, and its unit; a setting without a unit as it is.
pub(super) fn in_si(setting: &str) -> Result<(String, Option<Given>), QuantityCause> {
    let as_it_is = || Ok((setting.to_owned(), None));
    let Some((name, value)) = split_unquoted(setting, '=') else { return as_it_is() };
    if let Some(gauge) = value.trim().strip_suffix(" gauge").and_then(read) {
        let (gauge, absolute) = gauge_in_bar(gauge.value);
        let absolute = format!("{}={absolute}", name.trim());
        return Err(QuantityCause::Gauge { setting: setting.to_owned(), gauge, absolute });
    }
    let Some((_, unit)) = split(value).filter(|(_, unit)| !unit.is_empty()) else {
        return as_it_is();
    };
    let Some(found) = read(value) else {
        let known = Unit::symbols().collect::<Vec<_>>();
        let near = did_you_mean(unit, known.iter().copied()).map(str::to_owned);
        let (setting, unit) = (setting.to_owned(), unit.to_owned());
        return Err(QuantityCause::UnknownUnit { setting, unit, near });
    };
    let name = name.trim().to_owned();
    let text = format!("{name}={:?}", found.value);
    Ok((text, Some(Given { name, quantity: found })))
}

/// A gauge pressure in Pa, and the absolute one at the standard atmosphere, both in bar.
fn gauge_in_bar(pressure: f64) -> (String, String) {
    let bar = |pascal: f64| format!("{} bar", (pascal / 1e5 * 1e9).round() / 1e9);
    (bar(pressure), bar(pressure + 101_325.0))
}

/// The size and zero of a unit of the user, in SI units, and what it measures.
pub fn scale_of(unit: &str) -> Option<(Scale, Dimension)> {
    match unit {
        "" => return Some((Scale { factor: 1.0, offset: 0.0 }, Dimension::ONE)),
        "%" => return Some((Scale { factor: 1e-2, offset: 0.0 }, Dimension::ONE)),
        _ => {}
    }
    let unit = match unit.trim_start_matches('°') {
        plain if plain.len() < unit.len() => format!("deg{plain}"),
        plain => plain.replace('µ', "u").replace('^', "").replace("Nm", "N.m"),
    };
    let unit = Unit::of(&unit)?;
    Some((unit.scale?, unit.dimension))
}

/// A number and the unit after it. None for anything that does not begin with a number, or that goes on otherwise.
fn split(text: &str) -> Option<(&str, &str)> {
    let text = text.trim();
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let mut at = usize::from(text.starts_with(['-', '+']));
    let whole = digits(at);
    at += whole;
    if bytes.get(at) == Some(&b'.') {
        at += 1 + digits(at + 1);
    }
    if whole == 0 {
        return None;
    }
    if matches!(bytes.get(at), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(at + 1), Some(b'-' | b'+')));
        let exponent = digits((at + 1 + sign).min(bytes.len()));
        if exponent > 0 {
            at += 1 + sign + exponent;
        }
    }
    let unit = text[at..].trim();
    let is_unit = unit.is_empty()
        || unit.starts_with(|c: char| c.is_alphabetic() || matches!(c, '%' | '°' | 'µ'))
            && unit.chars().all(|c| c.is_alphanumeric() || "%°µ/.^()-".contains(c));
    is_unit.then(|| (&text[..at], unit))
}

/// The value without the last rounding error of the conversion: 12 ms is 0.012 s.
fn tidy(value: f64) -> f64 {
    let near: f64 = format!("{value:.14e}").parse().unwrap_or(value);
    if (near - value).abs() <= 4.0 * f64::EPSILON * value.abs() { near } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_are_converted_to_si() {
        let of = |text: &str| read(text).map(|q| q.value);
        assert_eq!(of("6 bar"), Some(6e5));
        assert_eq!(of("12ms"), Some(0.012));
        assert_eq!(of(" -2.5e-1 mm"), Some(-2.5e-4));
        assert_eq!(of("20 °C"), Some(293.15));
        assert_eq!(of("20 degC"), Some(293.15));
        assert_eq!(of("60 l/min"), Some(1e-3));
        assert_eq!(of("5 Nm"), Some(5.0));
        assert_eq!(of("50 %"), Some(0.5));
        assert_eq!(of("7"), Some(7.0));
        assert_eq!(of("2 um"), Some(2e-6));
        assert_eq!(of("5 kg"), Some(5.0));
        for other in ["x", "6 baar", "2*3", "{1, 2}", "1 + 2", "", "\"6 bar\""] {
            assert_eq!(of(other), None, "{other}");
        }
    }

    #[test]
    fn values_are_in_the_unit_of_the_declaration() {
        let of = |text: &str, declared: &str| read(text).and_then(|q| q.in_unit(declared));
        assert_eq!(of("3e5 Pa", "bar"), Some(3.0));
        assert_eq!(of("30 degC", "degC"), Some(30.0));
        assert_eq!(of("300 K", "degC"), Some(26.85));
        assert_eq!(of("20 degC", "K"), Some(293.15));
        assert_eq!(of("60 rpm", "rpm"), Some(60.0));
        assert_eq!(of("7", "bar"), Some(7.0));
        assert_eq!(of("50 %", ""), Some(0.5));
        for (text, declared) in
            [("3 m", "bar"), ("10 Hz", "rad/s"), ("3 rpm", "Hz"), ("1 m", "furlong")]
        {
            assert_eq!(of(text, declared), None, "{text} in {declared}");
        }
        let degrees = conversion("degC", "degF").unwrap();
        assert!((degrees.of(20.0) - 68.0).abs() < 1e-9);
    }

    #[test]
    fn settings_without_units_stay_as_they_are() {
        let text = |setting: &str| in_si(setting).map(|(text, _)| text).ok();
        assert_eq!(text("p = 6 bar").as_deref(), Some("p=600000.0"));
        for setting in ["p=6e5", "p=2*q", "s={1, 2}", "b=true", "name=\"6 bar\"", "p"] {
            assert_eq!(text(setting).as_deref(), Some(setting));
        }
        assert!(in_si("p=6 baar").is_err());
    }
}
