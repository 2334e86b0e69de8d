//! Builds, prints and reads JSON. Sole user of `serde_json`.

use serde_json::{Map, Number, Value};

/// A JSON value. The members of objects are sorted by key.
#[derive(Clone, PartialEq, Debug)]
pub struct Json(Value);

impl Json {
    /// A number; `null` if it is not finite, which JSON cannot represent.
    pub fn number(x: f64) -> Json {
        Json(Number::from_f64(x).map_or(Value::Null, Value::Number))
    }

    /// Reads a value. The error is a message.
    pub fn parse(text: &str) -> Result<Json, String> {
        serde_json::from_str(text).map(Json).map_err(|e| e.to_string())
    }

    /// A part by its keys, each the name of a member.
    pub fn at(&self, keys: &[&str]) -> Option<Json> {
        let found = keys.iter().try_fold(&self.0, |value, key| value.get(key));
        found.filter(|value| !value.is_null()).cloned().map(Json)
    }

    /// The string at some keys.
    pub fn text_at(&self, keys: &[&str]) -> Option<&str> {
        keys.iter().try_fold(&self.0, |value, key| value.get(key))?.as_str()
    }

    /// The count at some keys.
    pub fn count_at(&self, keys: &[&str]) -> Option<usize> {
        let found = keys.iter().try_fold(&self.0, |value, key| value.get(key))?;
        found.as_u64().and_then(|n| usize::try_from(n).ok())
    }

    /// The items of the array at some keys; none without an array.
    pub fn items_at(&self, keys: &[&str]) -> Vec<Json> {
        let found = keys.iter().try_fold(&self.0, |value, key| value.get(key));
        found
            .and_then(Value::as_array)
            .map_or(Vec::new(), |items| items.iter().cloned().map(Json).collect())
    }

    /// `null`.
    pub fn null() -> Json {
        Json(Value::Null)
    }

    /// A count.
    pub fn count(n: usize) -> Json {
        Json(Value::from(n))
    }

    /// An integer.
    pub fn integer(n: i64) -> Json {
        Json(Value::from(n))
    }

    /// A Boolean.
    pub fn flag(flag: bool) -> Json {
        Json(Value::Bool(flag))
    }

    /// A string.
    pub fn text(text: impl Into<String>) -> Json {
        Json(Value::String(text.into()))
    }

    /// An array.
    pub fn list(items: impl IntoIterator<Item = Json>) -> Json {
        Json(Value::Array(items.into_iter().map(|j| j.0).collect()))
    }

    /// An array of numbers.
    pub fn numbers(numbers: &[f64]) -> Json {
        Json::list(numbers.iter().map(|x| Json::number(*x)))
    }

    /// An object.
    pub fn object<K: Into<String>>(members: impl IntoIterator<Item = (K, Json)>) -> Json {
        let members: Map<String, Value> =
            members.into_iter().map(|(key, value)| (key.into(), value.0)).collect();
        Json(Value::Object(members))
    }

    /// Prints the value in one line.
    pub fn compact(&self) -> String {
        self.0.to_string()
    }

    /// Prints the value with indentation and a final line end.
    pub fn pretty(&self) -> String {
        format!("{:#}\n", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_are_not_finite_become_null() {
        let numbers = Json::numbers(&[0.1, f64::INFINITY, f64::NAN, -2e-300]);
        let all = Json::object([("x", numbers), ("says \"so\"", Json::text("a\nb"))]);
        let text = all.pretty();
        let squeezed: String = text.split_whitespace().collect();
        assert_eq!(squeezed, r#"{"says\"so\"":"a\nb","x":[0.1,null,null,-2e-300]}"#);
    }
}
