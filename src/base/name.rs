//! Interned identifiers and texts. A [`Name`] is one pointer: copied, compared and hashed without touching
//! the text; the text lives as long as the process.

use std::sync::RwLock;

use super::index::FastMap;

/// An interned identifier as written by the user (quoted identifiers keep their quotes).
pub type Name = ustr::Ustr;

/// Interns `text`.
pub fn name(text: &str) -> Name {
    ustr::ustr(text)
}

/// The names that have numbers.
#[derive(Default)]
struct Numbers {
    names: Vec<Name>,
    numbers: FastMap<Name, u32>,
}

static NUMBERS: RwLock<Option<Numbers>> = RwLock::new(None);

/// The number of a text, for what can hold nothing else: equal texts have equal numbers, and the empty
/// text has 0.
pub fn number(text: Name) -> u32 {
    // A run asks for the same texts again and again.
    let known = NUMBERS.read().unwrap_or_else(std::sync::PoisonError::into_inner);
    let found = known.as_ref().and_then(|k| k.numbers.get(&text).copied());
    drop(known);
    if let Some(found) = found {
        return found;
    }
    let mut known = NUMBERS.write().unwrap_or_else(std::sync::PoisonError::into_inner);
    let known = known.get_or_insert_with(|| {
        let empty = name("");
        Numbers { names: vec![empty], numbers: std::iter::once((empty, 0)).collect() }
    });
    *known.numbers.entry(text).or_insert_with(|| {
        known.names.push(text);
        known.names.len() as u32 - 1
    })
}

/// The text of a number; the empty one for what is no number of a text.
pub fn numbered(number: u32) -> Name {
    let known = NUMBERS.read().unwrap_or_else(std::sync::PoisonError::into_inner);
    let found = known.as_ref().and_then(|k| k.names.get(number as usize));
    found.copied().unwrap_or_else(|| name(""))
}
