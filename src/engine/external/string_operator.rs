//! Operators on strings at run time, where each string is represented by its id: equal strings have
//! equal ids.

use std::cmp::Ordering;

use super::printf::Form;
use super::{External, Signature, same_if_equal};
use crate::base::name::{name, string_id, string_of_id};

const fn string_valued(name: &'static str, arity: usize) -> Signature {
    Signature { name, arity, is_integer: false, is_differentiable: false }
}

/// `String(x)`: the id of a formatted number.
#[derive(Clone, PartialEq, Debug)]
pub struct FormatNumber {
    /// The format.
    pub form: Form,
    /// True for an Integer.
    pub is_integer: bool,
}

impl External for FormatNumber {
    fn signature(&self) -> Signature {
        string_valued("String", 1)
    }

    fn eval(&self, args: &[f64]) -> f64 {
        let formatted = self.form.of(args[0], self.is_integer).unwrap_or_default();
        f64::from(string_id(name(&formatted)))
    }

    same_if_equal!();
}

/// Length of a string that is joined, bytes: all strings of a run are kept.
const MAX_JOINED: usize = 1_000_000;

/// `a + b`: the id of two strings joined; NaN if they are too long.
#[derive(Clone, PartialEq, Debug)]
pub struct Concatenate;

impl External for Concatenate {
    fn signature(&self) -> Signature {
        string_valued("joinedTexts", 2)
    }

    fn eval(&self, args: &[f64]) -> f64 {
        let [a, b] = [args[0], args[1]].map(|id| string_of_id(id as u32));
        // No id is larger: a run fails where it meets it.
        if a.len() + b.len() > MAX_JOINED || args.iter().any(|id| id.is_nan()) {
            return f64::NAN;
        }
        f64::from(string_id(name(&format!("{a}{b}"))))
    }

    same_if_equal!();
}

/// `a < b` and the like: 1 if the lexicographic order of two strings is one of these, else 0.
#[derive(Clone, PartialEq, Debug)]
pub struct CompareStrings(pub Vec<Ordering>);

impl External for CompareStrings {
    fn signature(&self) -> Signature {
        string_valued("ordered", 2)
    }

    fn eval(&self, args: &[f64]) -> f64 {
        let [a, b] = [args[0], args[1]].map(|id| string_of_id(id as u32));
        f64::from(u8::from(self.0.contains(&a.as_str().cmp(b.as_str()))))
    }

    same_if_equal!();
}

#[cfg(test)]
mod tests {
    use super::*;

    fn id(s: &str) -> f64 {
        f64::from(string_id(name(s)))
    }

    #[test]
    fn operators_work_on_ids() {
        assert_eq!(Concatenate.eval(&[id("spool "), id("valve")]), id("spool valve"));
        let format = FormatNumber { form: Form::default(), is_integer: false };
        assert_eq!(format.eval(&[0.25]), id("0.25"));
        let at_most = CompareStrings(vec![Ordering::Less, Ordering::Equal]);
        let compare = |a, b| at_most.eval(&[id(a), id(b)]);
        assert_eq!([compare("a", "b"), compare("b", "b"), compare("b", "a")], [1.0, 1.0, 0.0]);
    }
}
