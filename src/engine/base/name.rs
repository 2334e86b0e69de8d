//! Interned identifiers and strings. A [`Name`] is one pointer: copied, compared and hashed without
//! touching the characters, which live as long as the process.

use std::cmp::Ordering;
use std::fmt::{self, Debug, Display};
use std::hash::{BuildHasher, Hash, Hasher};
use std::ops::Deref;
use std::sync::{Mutex, PoisonError, RwLock};

use hashbrown::HashTable;

use super::index::FastMap;

/// An interned identifier as written by the user (quoted identifiers keep their quotes).
#[derive(Clone, Copy)]
pub struct Name(&'static Interned);

/// A string that exists once.
struct Interned {
    text: Box<str>,
    hash: u64,
}

/// Number of tables, each with a lock of its own, that interned strings are spread over.
const TABLES: usize = 16;

static INTERNED: [Mutex<HashTable<Name>>; TABLES] =
    [const { Mutex::new(HashTable::new()) }; TABLES];

/// Interns `text`.
pub fn name(text: &str) -> Name {
    let hash = rustc_hash::FxBuildHasher.hash_one(text);
    // The table itself goes by other bits.
    let table = &INTERNED[(hash >> 32) as usize % TABLES];
    let mut table = table.lock().unwrap_or_else(PoisonError::into_inner);
    let is_it = |known: &Name| known.0.hash == hash && *known.0.text == *text;
    if let Some(known) = table.find(hash, is_it) {
        return *known;
    }
    let new = Name(Box::leak(Box::new(Interned { text: text.into(), hash })));
    table.insert_unique(hash, new, |known| known.0.hash);
    new
}

impl Name {
    /// The characters.
    pub fn as_str(&self) -> &'static str {
        &self.0.text
    }
}

impl Deref for Name {
    type Target = str;
    fn deref(&self) -> &str {
        &self.0.text
    }
}

impl PartialEq for Name {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.0, other.0)
    }
}

impl Eq for Name {}

impl Hash for Name {
    fn hash<H: Hasher>(&self, state: &mut H) {
        state.write_u64(self.0.hash);
    }
}

impl PartialOrd for Name {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Name {
    fn cmp(&self, other: &Self) -> Ordering {
        self.as_str().cmp(other.as_str())
    }
}

impl Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Display::fmt(self.as_str(), f)
    }
}

impl Debug for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Debug::fmt(self.as_str(), f)
    }
}

impl From<&str> for Name {
    fn from(text: &str) -> Self {
        name(text)
    }
}

impl PartialEq<str> for Name {
    fn eq(&self, other: &str) -> bool {
        self.as_str() == other
    }
}

impl PartialEq<&str> for Name {
    fn eq(&self, other: &&str) -> bool {
        self.as_str() == *other
    }
}

impl PartialEq<String> for Name {
    fn eq(&self, other: &String) -> bool {
        self.as_str() == other
    }
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
    let known = STRING_IDS.read().unwrap_or_else(PoisonError::into_inner);
    let found = known.as_ref().and_then(|k| k.ids.get(&text).copied());
    drop(known);
    if let Some(found) = found {
        return found;
    }
    let mut known = STRING_IDS.write().unwrap_or_else(PoisonError::into_inner);
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
    let known = STRING_IDS.read().unwrap_or_else(PoisonError::into_inner);
    let found = known.as_ref().and_then(|k| k.names.get(&id));
    found.copied().unwrap_or_else(|| name(""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_strings_are_one_name_in_all_threads() {
        let texts: Vec<String> = (0..500).map(|k| format!("x{}", k % 100)).collect();
        let all = || texts.iter().map(|text| name(text)).collect::<Vec<_>>();
        let (here, there) = std::thread::scope(|scope| {
            let there = scope.spawn(all);
            (all(), there.join().unwrap_or_default())
        });
        assert_eq!(here, there);
        assert!(here.iter().zip(&texts).all(|(name, text)| name == text));
        assert_eq!(here.iter().collect::<std::collections::BTreeSet<_>>().len(), 100);
        assert!(name("a") < name("b") && name("") < name("a"));
    }

    #[test]
    fn quoted_identifiers_are_whole() {
        assert_eq!(dotted_parts("a.'b.c'[1].d"), ["a", "'b.c'[1]", "d"]);
        assert_eq!(dotted_parts(r"'\'a.b\''.c"), [r"'\'a.b\''", "c"]);
        assert_eq!(split_unquoted("'a=b'=3=4", '='), Some(("'a=b'", "3=4")));
        assert_eq!(split_unquoted("ab", '='), None);
        assert_eq!(without_spaces(" a[1, 2].'b c' "), "a[1,2].'b c'");
    }
}
