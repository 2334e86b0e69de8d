//! Values with their places, as a TOML file or an annotation holds them: strings, numbers, Booleans, lists and tables.

use super::source::Span;

/// A value and its place.
#[derive(Clone, PartialEq, Debug)]
pub struct Value {
    /// The value.
    pub kind: ValueKind,
    /// Its place.
    pub span: Span,
}

/// A value without its place.
#[derive(Clone, PartialEq, Debug)]
pub enum ValueKind {
    /// A string.
    Text(String),
    /// A number, as written but for separators of digits.
    Number(String),
    /// A Boolean.
    Flag(bool),
    /// A list.
    List(Vec<Value>),
    /// A table.
    Table(Table),
    /// Anything else, such as a date.
    Other,
}

/// Keys with their values, in order.
#[derive(Clone, PartialEq, Debug)]
pub struct Table {
    /// The entries.
    pub entries: Vec<Entry>,
    /// The place of the table.
    pub span: Span,
}

/// A key with its value.
#[derive(Clone, PartialEq, Debug)]
pub struct Entry {
    /// The key.
    pub key: String,
    /// The place of the key.
    pub key_span: Span,
    /// The value.
    pub value: Value,
}

/// A value that is being read.
#[derive(Clone, Copy, Debug)]
pub struct Item<'t>(&'t Value);

/// A table that is being read: the file itself, or a part of it.
#[derive(Clone, Copy, Debug)]
pub struct Section<'t>(&'t Table);

impl Table {
    /// The table, to be read.
    pub fn section(&self) -> Section<'_> {
        Section(self)
    }
}

impl<'t> Section<'t> {
    /// The value of a key.
    pub fn get(&self, key: &str) -> Option<Item<'t>> {
        self.0.entries.iter().find(|entry| entry.key == key).map(|entry| Item(&entry.value))
    }

    /// All keys with their values, in order.
    pub fn entries(&self) -> Vec<(String, Item<'t>)> {
        self.0.entries.iter().map(|entry| (entry.key.clone(), Item(&entry.value))).collect()
    }

    /// All keys with their places, in order.
    pub fn keys(&self) -> impl Iterator<Item = (&'t str, Span)> + use<'t> {
        self.0.entries.iter().map(|entry| (entry.key.as_str(), entry.key_span))
    }

    /// The place of the table.
    pub fn place(&self) -> Span {
        self.0.span
    }
}

impl<'t> Item<'t> {
    /// The place of the value.
    pub fn place(&self) -> Span {
        self.0.span
    }

    /// The string.
    pub fn text(&self) -> Option<String> {
        match &self.0.kind {
            ValueKind::Text(text) => Some(text.clone()),
            _ => None,
        }
    }

    /// The number.
    pub fn number(&self) -> Option<f64> {
        match &self.0.kind {
            ValueKind::Number(digits) => digits.parse().ok(),
            _ => None,
        }
    }

    /// The Boolean.
    pub fn flag(&self) -> Option<bool> {
        match self.0.kind {
            ValueKind::Flag(flag) => Some(flag),
            _ => None,
        }
    }

    /// A number, string or Boolean as written, strings without quotes.
    pub fn written(&self) -> Option<String> {
        match &self.0.kind {
            ValueKind::Text(text) | ValueKind::Number(text) => Some(text.clone()),
            ValueKind::Flag(flag) => Some(flag.to_string()),
            _ => None,
        }
    }

    /// The items of a list.
    pub fn list(&self) -> Option<Vec<Item<'t>>> {
        match &self.0.kind {
            ValueKind::List(list) => Some(list.iter().map(Item).collect()),
            _ => None,
        }
    }

    /// The table.
    pub fn section(&self) -> Option<Section<'t>> {
        match &self.0.kind {
            ValueKind::Table(table) => Some(Section(table)),
            _ => None,
        }
    }
}
