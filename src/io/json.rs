//! JSON, as text. Sole user of `serde_json`.

use serde_json::{Map, Number, Value};

/// A value on its way to a text. Objects keep their order in the alphabet of their keys.
#[derive(Clone, PartialEq, Debug)]
pub struct Json(Value);

impl Json {
    /// A number; `null` if it is not finite, for which JSON has no text.
    pub fn number(x: f64) -> Json {
        Json(Number::from_f64(x).map_or(Value::Null, Value::Number))
    }

    /// Nothing.
    pub fn null() -> Json {
        Json(Value::Null)
    }

    /// A count.
    pub fn count(n: usize) -> Json {
        Json(Value::from(n))
    }

    /// True or false.
    pub fn flag(flag: bool) -> Json {
        Json(Value::Bool(flag))
    }

    /// A text.
    pub fn text(text: impl Into<String>) -> Json {
        Json(Value::String(text.into()))
    }

    /// A list.
    pub fn list(items: impl IntoIterator<Item = Json>) -> Json {
        Json(Value::Array(items.into_iter().map(|j| j.0).collect()))
    }

    /// A list of numbers.
    pub fn numbers(numbers: &[f64]) -> Json {
        Json::list(numbers.iter().map(|x| Json::number(*x)))
    }

    /// Values by name.
    pub fn object<K: Into<String>>(members: impl IntoIterator<Item = (K, Json)>) -> Json {
        let members: Map<String, Value> =
            members.into_iter().map(|(key, value)| (key.into(), value.0)).collect();
        Json(Value::Object(members))
    }

    /// The text in one line.
    pub fn compact(&self) -> String {
        self.0.to_string()
    }

    /// The text, indented, with a line end.
    pub fn pretty(&self) -> String {
        format!("{:#}\n", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_json_cannot_say_is_null() {
        let numbers = Json::numbers(&[0.1, f64::INFINITY, f64::NAN, -2e-300]);
        let all = Json::object([("x", numbers), ("says \"so\"", Json::text("a\nb"))]);
        let text = all.pretty();
        let squeezed: String = text.split_whitespace().collect();
        assert_eq!(squeezed, r#"{"says\"so\"":"a\nb","x":[0.1,null,null,-2e-300]}"#);
    }
}
