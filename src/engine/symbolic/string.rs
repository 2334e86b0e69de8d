//! `String(...)`: conversion of values to strings.

use crate::ir::expr::{Const, Form, Graph};

/// The string of a value; `None` if the format is not one of its type.
pub fn text(graph: &Graph, value: Const, form: Form) -> Option<String> {
    let text = match value {
        Const::Real(bits) => return form.of(f64::from_bits(bits), false),
        Const::Integer(i) if form.format.is_none() => i.to_string(),
        Const::Integer(i) => return form.of(i as f64, true),
        Const::Boolean(b) => b.to_string(),
        Const::String(s) => s.to_string(),
        Const::Enumeration(t, k) => graph.enumerations[t].literals.get(k as usize - 1)?.to_string(),
    };
    Some(form.padded(text))
}
