//! Interned identifiers and strings. A [`Name`] is one pointer: copied, compared and hashed without
//! touching the characters, which live as long as the process.

use std::sync::RwLock;

use super::index::FastMap;

/// An interned identifier as written by the user (quoted identifiers keep their quotes).
pub type Name = ustr::Ustr;

/// Interns `text`.
pub fn name(text: &str) -> Name {
    ustr::ustr(text)
}

/// The strings that have an id.
#[derive(Default)]
struct StringIds {
    names: Vec<Name>,
    ids: FastMap<Name, u32>,
}

static STRING_IDS: RwLock<Option<StringIds>> = RwLock::new(None);

/// The id of a string, for storage that can only hold numbers: equal strings have equal ids, and
/// the empty string has the id 0.
pub fn string_id(text: Name) -> u32 {
    // A simulation asks for the same few strings repeatedly, so try the shared lock first.
    let known = STRING_IDS.read().unwrap_or_else(std::sync::PoisonError::into_inner);
    let found = known.as_ref().and_then(|k| k.ids.get(&text).copied());
    drop(known);
    if let Some(found) = found {
        return found;
    }
    let mut known = STRING_IDS.write().unwrap_or_else(std::sync::PoisonError::into_inner);
    let known = known.get_or_insert_with(|| {
        let empty = name("");
        StringIds { names: vec![empty], ids: std::iter::once((empty, 0)).collect() }
    });
    *known.ids.entry(text).or_insert_with(|| {
        known.names.push(text);
        known.names.len() as u32 - 1
    })
}

/// The string with this id; the empty string if no string has it.
pub fn string_of_id(id: u32) -> Name {
    let known = STRING_IDS.read().unwrap_or_else(std::sync::PoisonError::into_inner);
    let found = known.as_ref().and_then(|k| k.names.get(id as usize));
    found.copied().unwrap_or_else(|| name(""))
}
