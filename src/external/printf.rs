//! Formats numbers like `printf` of C (C17, section 7.21.6.1), for `String(...)` (Modelica
//! specification 3.6, section 3.7.1).

/// Format of a number.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Form {
    /// Significant digits of a Real.
    pub digits: u16,
    /// Minimum number of characters.
    pub width: u16,
    /// Left-justified.
    pub left: bool,
    /// A C format string, which takes precedence over `digits`.
    pub format: Option<&'static str>,
}

impl Default for Form {
    /// The defaults of `String(...)`.
    fn default() -> Self {
        Form { digits: 6, width: 0, left: true, format: None }
    }
}

impl Form {
    /// Formats a number, as an Integer if `whole`; `None` if the format string is invalid.
    pub fn of(self, x: f64, whole: bool) -> Option<String> {
        let text = match self.format {
            Some(format) => formatted(x, format)?,
            // Adding 0 makes -0 a 0.
            None if whole => format!("{:.0}", x + 0.0),
            None => general(x, usize::from(self.digits)),
        };
        Some(self.padded(text))
    }

    /// Pads a text to the minimum width.
    pub fn padded(self, text: String) -> String {
        let width = usize::from(self.width);
        if self.left { format!("{text:<width$}") } else { format!("{text:>width$}") }
    }
}

/// Formats a number like `%.<digits>g` of C.
pub fn general(x: f64, digits: usize) -> String {
    let digits = digits.max(1);
    if x == 0.0 {
        return "0".to_string();
    }
    let (mantissa, exponent) = scientific(x, digits - 1);
    let trimmed = |text: &str| {
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_string()
        } else {
            text.to_string()
        }
    };
    if exponent < -4 || exponent >= digits as i32 {
        return with_exponent(&trimmed(&mantissa), exponent);
    }
    let places = (digits as i32 - 1 - exponent).max(0) as usize;
    trimmed(&format!("{x:.places$}"))
}

/// Formats a number by a format string such as `2.6f`, `-10.3e` or `.4g`; `None` if it is invalid.
pub fn formatted(x: f64, format: &str) -> Option<String> {
    let format = format.strip_prefix('%').unwrap_or(format);
    let kind = format.chars().last().filter(|c| c.is_ascii_alphabetic())?;
    let rest = &format[..format.len() - 1];
    let (flags, rest) = rest.split_at(rest.find(|c| !"-+ 0#".contains(c)).unwrap_or(rest.len()));
    let (width, places) = match rest.split_once('.') {
        Some((width, places)) => (width, places.parse::<usize>().ok()?.min(60)),
        None => (rest, 6),
    };
    let width = if width.is_empty() { 0 } else { width.parse::<usize>().ok()?.min(200) };
    let mut text = match kind {
        'f' | 'F' => format!("{x:.places$}"),
        'e' | 'E' => {
            let (mantissa, exponent) = scientific(x, places);
            with_exponent(&mantissa, exponent)
        }
        'g' | 'G' => general(x, places),
        'd' | 'i' => format!("{x:.0}"),
        _ => return None,
    };
    if kind.is_ascii_uppercase() {
        text = text.to_uppercase();
    }
    if flags.contains('+') && x >= 0.0 {
        text.insert(0, '+');
    }
    let left = flags.contains('-');
    Some(if left { format!("{text:<width$}") } else { format!("{text:>width$}") })
}

/// Mantissa with `places` decimals, and decimal exponent.
fn scientific(x: f64, places: usize) -> (String, i32) {
    let text = format!("{x:.places$e}");
    match text.split_once('e') {
        Some((mantissa, exponent)) => (mantissa.to_string(), exponent.parse().unwrap_or(0)),
        None => (text, 0),
    }
}

fn with_exponent(mantissa: &str, exponent: i32) -> String {
    let sign = if exponent < 0 { '-' } else { '+' };
    format!("{mantissa}e{sign}{:02}", exponent.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_formatted_as_in_c() {
        // From the C standard's rules for `%g`, `%f` and `%e` (C17, section 7.21.6.1).
        assert_eq!(general(111.222, 6), "111.222");
        assert_eq!(general(std::f64::consts::PI, 4), "3.142");
        assert_eq!(general(1e6, 6), "1e+06");
        assert_eq!(general(123_456.0, 6), "123456");
        assert_eq!(general(-0.000_05, 6), "-5e-05");
        assert_eq!(general(0.0001, 6), "0.0001");
        assert_eq!(general(0.1 + 0.2, 6), "0.3");
        assert_eq!(formatted(5.235_353_534_5, "2.6f").as_deref(), Some("5.235354"));
        assert_eq!(formatted(6565.35, "2.0e").as_deref(), Some("7e+03"));
        assert_eq!(formatted(1.5, "8.2f").as_deref(), Some("    1.50"));
        assert_eq!(formatted(1.5, "-8.2f").as_deref(), Some("1.50    "));
        assert_eq!(formatted(1.5, "+.1f").as_deref(), Some("+1.5"));
        assert_eq!(formatted(1.5, "what"), None);
    }
}
