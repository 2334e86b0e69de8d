//! TOML files with the place of each value: plans, tests of models and settings of projects.
//!
//! In: a text. Out: the values of the keys that its reader asks for, and diagnostics for everything else in it.

use std::path::Path;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::cause::causes;
use super::diag::{Diagnostic, Problems, did_you_mean, did_you_mean_or};
use super::document::{Entry, Item, Section, Table, Value, ValueKind};
use super::source::{FileId, SourceMap, Span};

causes! {
    /// Causes found in any TOML file.
    pub enum TomlCause {
        /// A plan, or a file of tests or settings, is not a TOML file.
        error MO1400 NotToml { why: String, is_model: bool }
            => ("not a TOML file: {why}"), remedy(Some(not_toml(*is_model).to_owned()));
        /// A required key of a plan or test is missing.
        error MO1401 MissingKey { key: String }
            => ("`{key}` is missing"), remedy(Some(addition(key)));
        /// A key of a plan, of a test or of settings is unknown.
        error MO1402 UnknownKey { key: String, near: Option<String>, known: String }
            => ("unknown key `{key}`"), remedy(did_you_mean_or(near, format!("known here: {known}")));
        /// A value of a plan, of a test or of settings has the wrong type.
        error MO1403 WrongType { key: String, expected: &'static str }
            => ("`{key}` must be {expected}"), help("write {expected}");
    }
}

/// How a key is added: `[[test]]` begins a table.
fn addition(key: &str) -> String {
    if key.starts_with('[') { format!("add a table `{key}`") } else { format!("add `{key} = ...`") }
}

/// Reads a document and collects the diagnostics about it.
pub struct Reader<'p> {
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
    let root = match DeTable::parse(text) {
        Ok(root) => root,
        Err(why) => {
            let span = why.span().unwrap_or(0..0);
            let (why, is_model) = (why.message().to_owned(), is_modelica(text));
            let cause = TomlCause::NotToml { why, is_model };
            problems.push(Diagnostic::new(cause, Span::new(file, span.start, span.end)));
            return None;
        }
    };
    // An empty file is empty at its start.
    let whole = Span::new(file, 0, text.len().min(1));
    read_table(&table(root.get_ref(), whole), problems, by)
}

/// Reads a table by a function that is passed it. None if there were errors, which are added to `problems`.
pub fn read_table<T>(
    table: &Table,
    problems: &mut Problems,
    by: impl FnOnce(&mut Reader<'_>, Section<'_>) -> T,
) -> Option<T> {
    let before = problems.error_count();
    let out = by(&mut Reader { problems }, table.section());
    (problems.error_count() == before).then_some(out)
}

fn table(parsed: &DeTable<'_>, span: Span) -> Table {
    let entry = |(key, value): (&Spanned<_>, &Spanned<DeValue<'_>>)| {
        let key_span = place(span.file, key);
        let key: &std::borrow::Cow<'_, str> = key.get_ref();
        Entry { key: key.to_string(), key_span, value: value_of(span.file, value) }
    };
    Table { entries: parsed.iter().map(entry).collect(), span }
}

fn value_of(file: FileId, parsed: &Spanned<DeValue<'_>>) -> Value {
    let span = place(file, parsed);
    let digits = |text: &str| ValueKind::Number(text.replace('_', ""));
    let kind = match parsed.get_ref() {
        DeValue::String(text) => ValueKind::Text(text.to_string()),
        DeValue::Float(x) => digits(x.as_str()),
        DeValue::Integer(i) => digits(i.as_str()),
        DeValue::Boolean(flag) => ValueKind::Flag(*flag),
        DeValue::Array(list) => {
            ValueKind::List(list.iter().map(|value| value_of(file, value)).collect())
        }
        DeValue::Table(parsed) => ValueKind::Table(table(parsed, span)),
        DeValue::Datetime(_) => ValueKind::Other,
    };
    Value { kind, span }
}

fn place<T>(file: FileId, of: &Spanned<T>) -> Span {
    let span = of.span();
    Span::new(file, span.start, span.end)
}

impl Reader<'_> {
    /// Adds a diagnostic.
    pub fn report(&mut self, diagnostic: Diagnostic) {
        self.problems.push(diagnostic);
    }

    /// Whether no error has been reported.
    pub fn is_clean(&self) -> bool {
        !self.problems.has_errors()
    }

    /// Reports keys other than these.
    pub fn known(&mut self, section: &Section<'_>, keys: &[&str]) {
        for (name, place) in section.keys() {
            if !keys.contains(&name) {
                let near = did_you_mean(name, keys.iter().copied()).map(str::to_owned);
                let known = keys.join(", ");
                let cause = TomlCause::UnknownKey { key: name.to_owned(), near, known };
                self.problems.push(Diagnostic::new(cause, place));
            }
        }
    }

    /// Reports a value of the wrong type.
    pub fn wrong(&mut self, key: &str, item: Item<'_>, expected: &'static str) {
        let cause = TomlCause::WrongType { key: key.to_owned(), expected };
        self.problems.push(Diagnostic::new(cause, item.place()));
    }

    /// Reports a key that is missing.
    pub fn missing(&mut self, key: &str, section: &Section<'_>) {
        let cause = TomlCause::MissingKey { key: key.to_owned() };
        self.problems.push(Diagnostic::new(cause, section.place()));
    }

    /// The string of a key that must be there; empty if it is not.
    pub fn required(&mut self, section: &Section<'_>, key: &str) -> String {
        if section.get(key).is_none() {
            self.missing(key, section);
        }
        self.text(section, key).unwrap_or_default()
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

    /// The number of a key.
    pub fn number(&mut self, section: &Section<'_>, key: &str) -> Option<f64> {
        self.value(section, key, "a number", |item| item.number())
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

    /// The keys and values of the table of a key; none without it.
    pub fn entries<'t>(&mut self, section: &Section<'t>, key: &str) -> Vec<(String, Item<'t>)> {
        self.section(section, key).map(|table| table.entries()).unwrap_or_default()
    }

    /// The keys and tables of the table of a key; none without it. Reports values other than tables.
    pub fn tables<'t>(
        &mut self,
        section: &Section<'t>,
        key: &str,
        expected: &'static str,
    ) -> Vec<(String, Section<'t>)> {
        let mut out = Vec::new();
        for (name, item) in self.entries(section, key) {
            match item.section() {
                Some(own) => out.push((name, own)),
                None => self.wrong(&name, item, expected),
            }
        }
        out
    }

    /// The settings `NAME=VALUE` in the table of a key.
    pub fn settings(&mut self, section: &Section<'_>, key: &str) -> Vec<String> {
        let mut out = Vec::new();
        for (name, item) in self.entries(section, key) {
            match item.written() {
                Some(value) => out.push(format!("{name}={value}")),
                None => self.wrong(&name, item, "a number, a string, `true` or `false`"),
            }
        }
        out
    }

    /// The tables of a key that is repeated as `[[key]]`.
    pub fn sections<'t>(&mut self, section: &Section<'t>, key: &str) -> Vec<Section<'t>> {
        let read = |item: Item<'t>| item.list()?.iter().map(Item::section).collect();
        self.value(section, key, "tables with the heading `[[...]]`", read).unwrap_or_default()
    }
}

fn not_toml(is_model: bool) -> &'static str {
    match is_model {
        true => "this is a model, not a plan: `mocc plan MODEL RECORDINGS` writes one for it",
        false => {
            "strings are in quotes, lists in brackets; the guide of the command shows complete files"
        }
    }
}

/// Whether a text begins as a Modelica file does.
fn is_modelica(text: &str) -> bool {
    let mut lines = text.lines().map(str::trim);
    let first = lines.find(|line| !line.is_empty() && !line.starts_with("//"));
    let mut words = first.unwrap_or_default().split_whitespace();
    let opening = ["model", "package", "within", "block", "class", "partial", "encapsulated"];
    words.next().is_some_and(|word| opening.contains(&word)) && words.next() != Some("=")
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
        assert!(is_modelica("// A tank.\nwithin Plant;\n") && !is_modelica("model = \"tank.mo\""));
    }
}
