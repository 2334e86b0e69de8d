//! Interned identifiers. A [`Name`] is one pointer: copied, compared and hashed without touching
//! the text; the text lives as long as the process.

/// An interned identifier as written by the user (quoted identifiers keep their quotes).
pub type Name = ustr::Ustr;

/// Interns `text`.
pub fn name(text: &str) -> Name {
    ustr::ustr(text)
}
