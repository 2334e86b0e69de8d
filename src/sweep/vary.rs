//! The axes of a sweep: `p_supply=2e5:9e5:8`, `t_dwell=1,30,3600`, `friction_law=Friction.Kind.LuGre`.

use super::error::SweepError;
use crate::base::name::{split_unquoted, without_spaces};

/// A parameter and its values.
#[derive(Clone, PartialEq, Debug)]
pub struct Axis {
    /// Dotted name.
    pub name: String,
    /// The argument.
    pub text: String,
    /// Its values.
    pub values: Values,
}

/// The values of a parameter.
#[derive(Clone, PartialEq, Debug)]
pub enum Values {
    /// Evenly spaced between two numbers, both included; without a number of points it can only be sampled.
    Range {
        /// First value, SI.
        from: f64,
        /// Last value, SI.
        to: f64,
        /// Points, at least two.
        count: Option<u64>,
    },
    /// A list.
    Levels(Vec<Value>),
}

/// A value of a parameter.
#[derive(Clone, PartialEq, Debug)]
pub enum Value {
    /// A number, SI.
    Number(f64),
    /// Another Modelica expression: `true`, a literal of an enumeration, an array.
    Text(String),
}

impl Value {
    /// As a Modelica expression; an integral number can be assigned to an Integer.
    pub fn expression(&self) -> String {
        const EXACT: f64 = 9_007_199_254_740_992.0;
        match self {
            Value::Number(x) if x.fract() == 0.0 && x.abs() < EXACT => format!("{x:.0}"),
            Value::Number(x) => format!("{x:e}"),
            Value::Text(text) => text.clone(),
        }
    }

    fn of(text: &str) -> Value {
        match text.parse::<f64>() {
            Ok(x) if x.is_finite() && !text.contains(['i', 'n']) => Value::Number(x),
            _ => Value::Text(text.to_owned()),
        }
    }
}

impl Axis {
    /// Reads `NAME=VALUES`.
    pub fn read(text: &str) -> Result<Axis, SweepError> {
        let wrong = |why| SweepError::Vary { text: text.to_owned(), why };
        let (name, values) = split_unquoted(text, '=').ok_or_else(|| wrong("`=` is missing"))?;
        let (name, values) = (name.trim(), values.trim());
        if name.is_empty() {
            return Err(wrong("the name is missing"));
        }
        let items = items(values);
        if items.iter().any(|item| item.is_empty()) {
            return Err(wrong("a value is missing"));
        }
        let values = match items.as_slice() {
            [one] if one.contains(':') => range(one).map_err(wrong)?,
            _ => Values::Levels(items.iter().map(|item| Value::of(item)).collect()),
        };
        let name = without_spaces(name);
        Ok(Axis { name, text: text.to_owned(), values })
    }

    /// Number of points of a grid.
    pub fn count(&self) -> Result<u64, SweepError> {
        match &self.values {
            Values::Range { count, .. } => {
                count.ok_or_else(|| SweepError::NoCount(self.text.clone()))
            }
            Values::Levels(list) => Ok(list.len() as u64),
        }
    }

    /// The point `k` of a grid.
    pub fn point(&self, k: u64) -> Value {
        match &self.values {
            Values::Range { from, to, count } => {
                let last = count.map_or(1, |n| n.saturating_sub(1)).max(1);
                // The ends are exact.
                let value =
                    if k >= last { *to } else { from + (to - from) * (k as f64 / last as f64) };
                Value::Number(value)
            }
            Values::Levels(list) => list[(k as usize).min(list.len() - 1)].clone(),
        }
    }

    /// The value at a position within the range, from 0 to 1; each item of a list has an equal part.
    pub fn at(&self, part: f64) -> Value {
        match &self.values {
            Values::Range { from, to, .. } => Value::Number(from + (to - from) * part),
            Values::Levels(list) => {
                list[((part * list.len() as f64) as usize).min(list.len() - 1)].clone()
            }
        }
    }

    /// Whether all values are numbers.
    pub fn is_numeric(&self) -> bool {
        match &self.values {
            Values::Range { .. } => true,
            Values::Levels(list) => list.iter().all(|v| matches!(v, Value::Number(_))),
        }
    }
}

/// The items between commas outside brackets.
fn items(text: &str) -> Vec<String> {
    let mut out = vec![String::new()];
    let mut depth = 0;
    for c in text.chars() {
        match c {
            '{' | '(' | '[' => depth += 1,
            '}' | ')' | ']' => depth -= 1,
            ',' if depth == 0 => {
                out.push(String::new());
                continue;
            }
            _ => {}
        }
        if let Some(last) = out.last_mut() {
            last.push(c);
        }
    }
    out.into_iter().map(|item| item.trim().to_owned()).collect()
}

fn range(text: &str) -> Result<Values, &'static str> {
    let number = |part: &str| {
        part.trim().parse::<f64>().ok().filter(|x| x.is_finite()).ok_or("its ends are not numbers")
    };
    let parts: Vec<&str> = text.split(':').collect();
    let (from, to, count) = match parts.as_slice() {
        [from, to] => (number(from)?, number(to)?, None),
        [from, to, count] => {
            let count = count.trim().parse::<u64>().ok().filter(|n| *n >= 2);
            (
                number(from)?,
                number(to)?,
                Some(count.ok_or("the number of points must be 2 or more")?),
            )
        }
        _ => return Err("not a range"),
    };
    Ok(Values::Range { from, to, count })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_have_both_ends() {
        let axis = Axis::read("p = 2e5:9e5:8").unwrap();
        let points: Vec<Value> = (0..8).map(|k| axis.point(k)).collect();
        assert_eq!((axis.name.as_str(), axis.count().unwrap()), ("p", 8));
        let expected: Vec<Value> = (2..=9).map(|k| Value::Number(f64::from(k) * 1e5)).collect();
        assert_eq!(points, expected);
        let tenths = Axis::read("x=0:0.7:8").unwrap();
        assert_eq!(tenths.point(7), Value::Number(0.7));
    }

    #[test]
    fn lists_hold_numbers_and_expressions() {
        let axis = Axis::read("t=1, 30,3600").unwrap();
        assert_eq!((axis.count().unwrap(), axis.point(1)), (3, Value::Number(30.0)));
        let axis = Axis::read("a.k={1, 2},{3,4}").unwrap();
        assert_eq!((axis.count().unwrap(), axis.point(1).expression()), (2, "{3,4}".into()));
        assert!(!axis.is_numeric());
        let axis = Axis::read("law=Friction.Kind.Dahl").unwrap();
        assert_eq!(axis.point(0), Value::Text("Friction.Kind.Dahl".into()));
        assert_eq!(Value::of("inf"), Value::Text("inf".into()));
    }

    #[test]
    fn numbers_are_written_as_modelica_expressions() {
        let text = |x| Value::Number(x).expression();
        assert_eq!(
            (text(3.0), text(-2e5), text(0.25), text(1e300)),
            ("3".into(), "-200000".into(), "2.5e-1".into(), "1e300".into())
        );
    }

    #[test]
    fn malformed_axes_are_rejected() {
        let why = |text: &str| Axis::read(text).unwrap_err().to_string();
        assert!(why("p").contains("`=` is missing"));
        assert!(why("=1").contains("name is missing"));
        assert!(why("p=1:2:1").contains("2 or more"));
        assert!(why("p=1:x:3").contains("not numbers"));
        assert!(why("p=1,,2").contains("a value is missing"));
        assert!(Axis::read("p=1:2").unwrap().count().unwrap_err().to_string().contains("lhs:N"));
    }
}
