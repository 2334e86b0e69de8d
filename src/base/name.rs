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

/// Splits a text at the first separator that is not inside of a quoted identifier, such as `'a.b'`.
pub fn split_unquoted(text: &str, separator: char) -> Option<(&str, &str)> {
    let (mut is_quoted, mut is_escaped) = (false, false);
    for (at, c) in text.char_indices() {
        match c {
            _ if is_escaped => is_escaped = false,
            '\\' if is_quoted => is_escaped = true,
            '\'' => is_quoted = !is_quoted,
            c if c == separator && !is_quoted => {
                return Some((&text[..at], &text[at + c.len_utf8()..]));
            }
            _ => {}
        }
    }
    None
}

/// A name without the spaces outside of quoted identifiers: `a[1, 2]` as `a[1,2]`, and `'a b'` as it is.
pub fn without_spaces(text: &str) -> String {
    let (mut is_quoted, mut is_escaped) = (false, false);
    let kept = |c: &char| {
        match c {
            _ if is_escaped => is_escaped = false,
            '\\' if is_quoted => is_escaped = true,
            '\'' => is_quoted = !is_quoted,
            _ => {}
        }
        is_quoted || !c.is_whitespace()
    };
    text.chars().filter(kept).collect()
}

/// The parts of a dotted name; those in quotes are whole.
pub fn dotted_parts(mut text: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    while let Some((part, rest)) = split_unquoted(text, '.') {
        parts.push(part);
        text = rest;
    }
    parts.push(text);
    parts
}

/// The strings that have an id.
#[derive(Default)]
struct StringIds {
    names: FastMap<u32, Name>,
    ids: FastMap<Name, u32>,
}

static STRING_IDS: RwLock<Option<StringIds>> = RwLock::new(None);

/// The id of a string, for storage that can only hold numbers: equal strings have equal ids, and
/// the empty string has the id 0. Ids are hashes (FNV-1a, Fowler, Noll and Vo 1991), so that a string has
/// the same id in each process, unless that id is taken there by another string.
pub fn string_id(text: Name) -> u32 {
    if text.is_empty() {
        return 0;
    }
    // A simulation asks for the same few strings repeatedly, so try the shared lock first.
    let known = STRING_IDS.read().unwrap_or_else(std::sync::PoisonError::into_inner);
    let found = known.as_ref().and_then(|k| k.ids.get(&text).copied());
    drop(known);
    if let Some(found) = found {
        return found;
    }
    let mut known = STRING_IDS.write().unwrap_or_else(std::sync::PoisonError::into_inner);
    let known = known.get_or_insert_with(StringIds::default);
    if let Some(found) = known.ids.get(&text) {
        return *found;
    }
    let step = |hash: u32, byte: u8| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193);
    let mut id = text.bytes().fold(0x811c_9dc5, step).max(1);
    while known.names.contains_key(&id) {
        id = id.wrapping_add(1).max(1);
    }
    known.names.insert(id, text);
    known.ids.insert(text, id);
    id
}

/// The string with this id; the empty string if no string has it.
pub fn string_of_id(id: u32) -> Name {
    let known = STRING_IDS.read().unwrap_or_else(std::sync::PoisonError::into_inner);
    let found = known.as_ref().and_then(|k| k.names.get(&id));
    found.copied().unwrap_or_else(|| name(""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quoted_identifiers_are_whole() {
        assert_eq!(dotted_parts("a.'b.c'[1].d"), ["a", "'b.c'[1]", "d"]);
        assert_eq!(dotted_parts(r"'\'a.b\''.c"), [r"'\'a.b\''", "c"]);
        assert_eq!(split_unquoted("'a=b'=3=4", '='), Some(("'a=b'", "3=4")));
        assert_eq!(split_unquoted("ab", '='), None);
        assert_eq!(without_spaces(" a[1, 2].'b c' "), "a[1,2].'b c'");
    }
}
