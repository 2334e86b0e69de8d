//! TOML files with the place of each value: tests of models and settings of projects.
//!
//! In: a text. Out: the values of the keys that its reader asks for, and diagnostics for everything else in it.

use std::ops::Range;
use std::path::Path;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::cause::causes;
use super::diag::{Diagnostic, Problems, did_you_mean, did_you_mean_or};
use super::source::{FileId, SourceMap, Span};

causes! {
    /// Causes found in any TOML file.
    pub enum TomlCause {
        /// A file of tests or settings is not a TOML file.
        error MO1400 NotToml { why: String }
            => ("not a TOML file: {why}"),
            help("see `docs/guide/test.md` for complete test files");
        /// A required key of a test is missing.
        error MO1401 MissingKey { key: String }
            => ("`{key}` is missing"), help("add `{key} = ...`");
        /// A key of a test or of settings is unknown.
        error MO1402 UnknownKey { key: String, near: Option<String>, known: String }
            => ("unknown key `{key}`"), remedy(did_you_mean_or(near, format!("known here: {known}")));
        /// A value of a test or of settings has the wrong type.
        error MO1403 WrongType { key: String, expected: &'static str }
            => ("`{key}` must be {expected}"), help("write {expected}");
    }
}

/// A value.
#[derive(Clone, Copy)]
pub struct Item<'t>(&'t Spanned<DeValue<'t>>);

/// A table: the file itself, or a part of it.
#[derive(Clone)]
pub struct Section<'t> {
    table: &'t DeTable<'t>,
    span: Range<usize>,
}

/// Reads a file and collects the diagnostics about it.
pub struct Reader<'p> {
    file: FileId,
    problems: &'p mut Problems,
}

/// Reads a text by a function that is passed its root. None if there were errors, which are added to `problems`.
pub fn read<T>(
    path: &Path,
    text: &str,
    sources: &mut SourceMap,
    problems: &mut Problems,
    by: impl FnOnce(&mut Reader<'_>, Section<'_>) -> T,
) -> Option<T> {
    let file = sources.add(path, text);
    let before = problems.error_count();
    let root = match DeTable::parse(text) {
        Ok(root) => root,
        Err(why) => {
            let span = why.span().unwrap_or(0..0);
            let cause = TomlCause::NotToml { why: why.message().to_owned() };
            problems.push(Diagnostic::new(cause, Span::new(file, span.start, span.end)));
            return None;
        }
    };
    let mut reader = Reader { file, problems };
    // An empty file is empty at its start.
    let whole = Section { table: root.get_ref(), span: 0..text.len().min(1) };
    let out = by(&mut reader, whole);
    (problems.error_count() == before).then_some(out)
}

impl<'t> Section<'t> {
    /// The value of a key.
    pub fn get(&self, key: &str) -> Option<Item<'t>> {
        self.table.get(key).map(Item)
    }

    /// All keys with their values, in order.
    pub fn entries(&self) -> Vec<(String, Item<'t>)> {
        self.table.iter().map(|(key, value)| (key.get_ref().to_string(), Item(value))).collect()
    }
}

impl<'t> Item<'t> {
    /// The string.
    pub fn text(&self) -> Option<String> {
        match self.0.get_ref() {
            DeValue::String(text) => Some(text.to_string()),
            _ => None,
        }
    }

    /// The number.
    pub fn number(&self) -> Option<f64> {
        match self.0.get_ref() {
            DeValue::Float(x) => x.as_str().replace('_', "").parse().ok(),
            DeValue::Integer(i) => i.as_str().replace('_', "").parse().ok(),
            _ => None,
        }
    }

    /// The Boolean.
    pub fn flag(&self) -> Option<bool> {
        match self.0.get_ref() {
            DeValue::Boolean(flag) => Some(*flag),
            _ => None,
        }
    }

    /// A number, string or Boolean as written, strings without quotes.
    pub fn written(&self) -> Option<String> {
        match self.0.get_ref() {
            DeValue::String(text) => Some(text.to_string()),
            DeValue::Float(x) => Some(x.as_str().replace('_', "")),
            DeValue::Integer(i) => Some(i.as_str().replace('_', "")),
            DeValue::Boolean(flag) => Some(flag.to_string()),
            _ => None,
        }
    }

    /// The items of a list.
    pub fn list(&self) -> Option<Vec<Item<'t>>> {
        match self.0.get_ref() {
            DeValue::Array(list) => Some(list.iter().map(Item).collect()),
            _ => None,
        }
    }

    /// The table.
    pub fn section(&self) -> Option<Section<'t>> {
        match self.0.get_ref() {
            DeValue::Table(table) => Some(Section { table, span: self.0.span() }),
            _ => None,
        }
    }
}

impl Reader<'_> {
    /// The place of a value.
    pub fn place(&self, item: Item<'_>) -> Span {
        self.span(&item.0.span())
    }

    /// The place of a table.
    pub fn place_of(&self, section: &Section<'_>) -> Span {
        self.span(&section.span)
    }

    fn span(&self, span: &Range<usize>) -> Span {
        Span::new(self.file, span.start, span.end)
    }

    /// Adds a diagnostic.
    pub fn report(&mut self, diagnostic: Diagnostic) {
        self.problems.push(diagnostic);
    }

    /// Reports keys other than these.
    pub fn known(&mut self, section: &Section<'_>, keys: &[&str]) {
        for key in section.table.keys() {
            let name: &str = key.get_ref();
            if !keys.contains(&name) {
                let near = did_you_mean(name, keys.iter().copied()).map(str::to_owned);
                let known = keys.join(", ");
                let cause = TomlCause::UnknownKey { key: name.to_owned(), near, known };
                self.problems.push(Diagnostic::new(cause, self.span(&key.span())));
            }
        }
    }

    /// Reports a value of the wrong type.
    pub fn wrong(&mut self, key: &str, item: Item<'_>, expected: &'static str) {
        let cause = TomlCause::WrongType { key: key.to_owned(), expected };
        self.problems.push(Diagnostic::new(cause, self.place(item)));
    }

    /// Reports a key that is missing.
    pub fn missing(&mut self, key: &str, section: &Section<'_>) {
        let cause = TomlCause::MissingKey { key: key.to_owned() };
        self.problems.push(Diagnostic::new(cause, self.place_of(section)));
    }

    /// The value of a key by a function that reads it; reports a value that it does not accept.
    pub fn value<'t, T>(
        &mut self,
        section: &Section<'t>,
        key: &str,
        expected: &'static str,
        read: impl Fn(Item<'t>) -> Option<T>,
    ) -> Option<T> {
        let item = section.get(key)?;
        let value = read(item);
        if value.is_none() {
            self.wrong(key, item, expected);
        }
        value
    }

    /// The string of a key.
    pub fn text(&mut self, section: &Section<'_>, key: &str) -> Option<String> {
        self.value(section, key, "a string in quotes", |item| item.text())
    }

    /// The number of a key, positive or zero.
    pub fn size(&mut self, section: &Section<'_>, key: &str) -> Option<f64> {
        let read = |item: Item<'_>| item.number().filter(|x| *x >= 0.0 && x.is_finite());
        self.value(section, key, "a number that is not negative", read)
    }

    /// The Boolean of a key; false without it.
    pub fn flag(&mut self, section: &Section<'_>, key: &str) -> bool {
        self.value(section, key, "`true` or `false`", |item| item.flag()).unwrap_or(false)
    }

    /// The strings of a key, or its only one.
    pub fn texts(&mut self, section: &Section<'_>, key: &str) -> Option<Vec<String>> {
        self.value(section, key, "a list of strings", |item| match item.text() {
            Some(text) => Some(vec![text]),
            None => item.list()?.iter().map(|item| item.text()).collect(),
        })
    }

    /// The table of a key.
    pub fn section<'t>(&mut self, section: &Section<'t>, key: &str) -> Option<Section<'t>> {
        self.value(section, key, "a table `{ ... }`", |item| item.section())
    }

    /// The tables of a key that is repeated as `[[key]]`.
    pub fn sections<'t>(&mut self, section: &Section<'t>, key: &str) -> Vec<Section<'t>> {
        let read = |item: Item<'t>| item.list()?.iter().map(Item::section).collect();
        self.value(section, key, "tables with the heading `[[...]]`", read).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn messages(text: &str) -> Vec<String> {
        let (mut sources, mut problems) = (SourceMap::default(), Problems::new());
        read(Path::new("x.toml"), text, &mut sources, &mut problems, |r, root| {
            r.known(&root, &["name", "sizes", "part"]);
            r.texts(&root, "sizes");
            if r.text(&root, "name").is_none() && root.get("name").is_none() {
                r.missing("name", &root);
            }
            for part in r.sections(&root, "part") {
                r.size(&part, "x");
            }
        });
        problems.iter().map(|d| format!("{} {}", d.code, d.message)).collect()
    }

    #[test]
    fn values_of_the_wrong_type_are_reported() {
        assert_eq!(messages("name = \"a\"\nsizes = \"b\"\n[[part]]\nx = 1_0.5\n"), [""; 0]);
        assert_eq!(messages("nam = 1"), ["MO1402 unknown key `nam`", "MO1401 `name` is missing"]);
        assert_eq!(
            messages("name = 1\nsizes = [1]\n[[part]]\nx = -1"),
            [
                "MO1403 `sizes` must be a list of strings",
                "MO1403 `name` must be a string in quotes",
                "MO1403 `x` must be a number that is not negative"
            ]
        );
        assert!(messages("name = ")[0].starts_with("MO1400 not a TOML file"));
    }
}
