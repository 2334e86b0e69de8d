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

/// Formats a number by a format string such as `2.6f`, `-10.3e`, `.4g` or `05d`; `None` if it is
/// invalid. Conversions of Integers round a Real.
pub fn formatted(x: f64, format: &str) -> Option<String> {
    Conversion::parse(format)?.apply(x)
}

/// A conversion specification of C, without `*` and length modifiers.
struct Conversion {
    /// `-`
    left: bool,
    /// `+`
    plus: bool,
    /// A space.
    space: bool,
    /// `#`
    alternate: bool,
    /// `0`
    zero: bool,
    width: usize,
    precision: Option<usize>,
    kind: char,
}

/// A number without the characters that fill its field.
struct Digits {
    sign: &'static str,
    prefix: &'static str,
    text: String,
    /// Zeros may follow the sign.
    fills: bool,
}

impl Conversion {
    fn parse(format: &str) -> Option<Self> {
        let format = format.strip_prefix('%').unwrap_or(format);
        let kind = format.chars().last().filter(|c| c.is_ascii_alphabetic())?;
        let rest = &format[..format.len() - 1];
        let no_flag = rest.find(|c| !"-+ 0#".contains(c)).unwrap_or(rest.len());
        let (flags, rest) = rest.split_at(no_flag);
        let number = |text: &str, most: usize| match text {
            "" => Some(0),
            _ if text.bytes().all(|b| b.is_ascii_digit()) => {
                Some(text.parse::<usize>().unwrap_or(most).min(most))
            }
            _ => None,
        };
        let (width, precision) = match rest.split_once('.') {
            Some((width, precision)) => (width, Some(number(precision, 60)?)),
            None => (rest, None),
        };
        let has = |flag: char| flags.contains(flag);
        Some(Conversion {
            left: has('-'),
            plus: has('+'),
            space: has(' '),
            alternate: has('#'),
            zero: has('0'),
            width: number(width, 200)?,
            precision,
            kind,
        })
    }

    fn apply(&self, x: f64) -> Option<String> {
        let digits = match self.kind {
            'f' | 'F' | 'e' | 'E' | 'g' | 'G' => self.real(x),
            'd' | 'i' | 'u' | 'o' | 'x' | 'X' => self.integer(x),
            'c' => {
                let text = char::from_u32(x.round() as u32).unwrap_or(' ').to_string();
                Digits { sign: "", prefix: "", text, fills: false }
            }
            _ => return None,
        };
        Some(self.in_field(digits))
    }

    /// The sign of a number, as far as it is written.
    fn sign(&self, negative: bool) -> &'static str {
        match negative {
            true => "-",
            false if self.plus => "+",
            false if self.space => " ",
            false => "",
        }
    }

    fn real(&self, x: f64) -> Digits {
        let (magnitude, places) = (x.abs(), self.precision.unwrap_or(6));
        let sign = self.sign(x.is_sign_negative() && !x.is_nan());
        if !x.is_finite() {
            let text = if x.is_nan() { "nan" } else { "inf" };
            return Digits { sign, prefix: "", text: self.cased(text.into()), fills: false };
        }
        let text = match self.kind {
            'f' | 'F' => self.with_point(format!("{magnitude:.places$}")),
            'e' | 'E' => {
                let (mantissa, exponent) = scientific(magnitude, places);
                with_exponent(&self.with_point(mantissa), exponent)
            }
            _ if self.alternate => self.all_significant(magnitude, places.max(1)),
            _ => general(magnitude, places),
        };
        Digits { sign, prefix: "", text: self.cased(text), fills: true }
    }

    /// `#` of `g`: zeros at the end stay.
    fn all_significant(&self, magnitude: f64, digits: usize) -> String {
        let (mantissa, exponent) = scientific(magnitude, digits - 1);
        if exponent < -4 || exponent >= digits as i32 {
            return with_exponent(&self.with_point(mantissa), exponent);
        }
        let places = (digits as i32 - 1 - exponent).max(0) as usize;
        self.with_point(format!("{magnitude:.places$}"))
    }

    /// `#`: a decimal point also where no digit follows it.
    fn with_point(&self, text: String) -> String {
        match self.alternate && !text.contains('.') {
            true => text + ".",
            false => text,
        }
    }

    fn integer(&self, x: f64) -> Digits {
        let rounded = x.round() as i64;
        let signed = matches!(self.kind, 'd' | 'i');
        // A negative number has the bits of `unsigned int`.
        let bits = i32::try_from(rounded).map_or(rounded as u64, |small| u64::from(small as u32));
        let text = match self.kind {
            'd' | 'i' => rounded.unsigned_abs().to_string(),
            'o' => format!("{bits:o}"),
            'x' | 'X' => format!("{bits:x}"),
            _ => bits.to_string(),
        };
        let least = self.precision.unwrap_or(1);
        let text = match (rounded, self.precision) {
            (0, Some(0)) => String::new(),
            _ => format!("{text:0>least$}"),
        };
        let octal = self.kind == 'o' && self.alternate && !text.starts_with('0');
        let hexadecimal = matches!(self.kind, 'x' | 'X') && self.alternate && rounded != 0;
        Digits {
            sign: if signed { self.sign(rounded < 0) } else { "" },
            prefix: match self.kind {
                'X' if hexadecimal => "0X",
                _ if hexadecimal => "0x",
                _ if octal => "0",
                _ => "",
            },
            text: self.cased(text),
            fills: self.precision.is_none(),
        }
    }

    fn cased(&self, text: String) -> String {
        if self.kind.is_ascii_uppercase() { text.to_uppercase() } else { text }
    }

    /// Fills the field up to its width.
    fn in_field(&self, Digits { sign, prefix, text, fills }: Digits) -> String {
        let width = self.width;
        if self.zero && fills && !self.left {
            let rest = width.saturating_sub(sign.len() + prefix.len());
            return format!("{sign}{prefix}{text:0>rest$}");
        }
        let text = format!("{sign}{prefix}{text}");
        if self.left { format!("{text:<width$}") } else { format!("{text:>width$}") }
    }
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

    /// Each as `printf` of a C library writes it.
    #[test]
    fn flags_and_precisions_are_those_of_c() {
        let cases = [
            (7.0, "05d", "00007"),
            (-7.0, "05d", "-0007"),
            (7.0, "+d", "+7"),
            (7.0, " d", " 7"),
            (7.0, "+05d", "+0007"),
            (7.0, "-5d", "7    "),
            (7.0, "-05d", "7    "),
            (7.0, "5.3d", "  007"),
            (7.0, "05.3d", "  007"),
            (0.0, ".0d", ""),
            (3.5, "08.3f", "0003.500"),
            (-3.5, "08.3f", "-003.500"),
            (3.5, "+.1f", "+3.5"),
            (3.5, " .1f", " 3.5"),
            (2.0, "#.0f", "2."),
            (2.0, "#.0e", "2.e+00"),
            (2.0, "#g", "2.00000"),
            (0.0, "#.3g", "0.00"),
            (1e10, "#.3g", "1.00e+10"),
            (1234.5, "012.2e", "00001.23e+03"),
            (1e-7, "G", "1E-07"),
            (255.0, "x", "ff"),
            (255.0, "X", "FF"),
            (255.0, "#x", "0xff"),
            (255.0, "#X", "0XFF"),
            (255.0, "#08x", "0x0000ff"),
            (0.0, "#x", "0"),
            (255.0, ".4x", "00ff"),
            (8.0, "o", "10"),
            (8.0, "#o", "010"),
            (-1.0, "x", "ffffffff"),
            (7.0, "u", "7"),
            (65.0, "c", "A"),
            (65.0, "3c", "  A"),
        ];
        for (x, format, expected) in cases {
            assert_eq!(formatted(x, format).as_deref(), Some(expected), "{format} of {x}");
        }
        for wrong in ["*d", "ld", "5.x3d", "", "5", "d5"] {
            assert_eq!(formatted(1.0, wrong), None, "{wrong}");
        }
    }
}
