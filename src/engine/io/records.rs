//! Record tables: rows of numbers and strings without a time, with missing values, as CSV or
//! Parquet.

use std::io::Write;
use std::path::Path;

use thiserror::Error;

use super::atomic_file::{AtomicFile, WriteError};
use super::csv::{TableError, push_number, push_quoted};
use super::format::Format;

/// Type of a column.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Type {
    /// Numbers.
    Real,
    /// Integers.
    Integer,
    /// Strings.
    Text,
}

/// A column.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Field {
    /// Its name.
    pub name: String,
    /// Its type.
    pub ty: Type,
    /// SI unit; may be empty.
    pub unit: String,
    /// Its meaning; may be empty.
    pub description: String,
}

/// A value of the type of its column.
#[derive(Clone, PartialEq, Debug)]
pub enum Cell {
    /// No value.
    Missing,
    /// A finite number.
    Real(f64),
    /// An integer.
    Integer(i64),
    /// A string.
    Text(String),
}

/// Why a table was not written.
#[derive(Error, Debug)]
pub enum RecordError {
    /// A line that was read back is not a row of this table.
    #[error("a line of the journal is broken: `{0}`; start again with `--restart`")]
    Broken(String),
    /// Writing failed.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The file could not be created.
    #[error(transparent)]
    File(#[from] WriteError),
}

/// A row as a line of CSV (RFC 4180) without line end. Line breaks in strings become blanks.
/// Numbers read back exactly.
pub fn line(cells: &[Cell]) -> String {
    let mut text = Vec::new();
    for (i, cell) in cells.iter().enumerate() {
        if i > 0 {
            text.push(b',');
        }
        match cell {
            Cell::Missing => {}
            Cell::Real(x) => push_number(&mut text, *x, false),
            Cell::Integer(n) => text.extend_from_slice(n.to_string().as_bytes()),
            Cell::Text(t) => {
                let mut quoted = String::new();
                push_quoted(&mut quoted, &t.replace(['\n', '\r'], " "));
                text.extend_from_slice(quoted.as_bytes());
            }
        }
    }
    String::from_utf8(text).unwrap_or_default()
}

/// Parses a line to a row.
pub fn row(line: &str, fields: &[Field]) -> Result<Vec<Cell>, RecordError> {
    let broken = || RecordError::Broken(line.to_owned());
    let texts = parts(line);
    if texts.len() != fields.len() {
        return Err(broken());
    }
    let cell = |(text, field): (String, &Field)| match field.ty {
        _ if text.is_empty() => Ok(Cell::Missing),
        Type::Real => text.parse().map(Cell::Real).map_err(|_| broken()),
        Type::Integer => text.parse().map(Cell::Integer).map_err(|_| broken()),
        Type::Text => Ok(Cell::Text(text)),
    };
    texts.into_iter().zip(fields).map(cell).collect()
}

/// The fields of a line, without their quotes.
pub fn parts(line: &str) -> Vec<String> {
    let mut out = vec![String::new()];
    let mut quoted = false;
    let mut letters = line.chars().peekable();
    while let Some(c) = letters.next() {
        let Some(last) = out.last_mut() else { break };
        match c {
            '"' if quoted && letters.peek() == Some(&'"') => {
                letters.next();
                last.push('"');
            }
            '"' => quoted = !quoted,
            ',' if !quoted => out.push(String::new()),
            c => last.push(c),
        }
    }
    out
}

/// Writes a record table in one format; created by a row of [`FORMATS`](super::format::FORMATS).
pub trait RecordWriter {
    /// Writes a row, given as a line of CSV and as cells.
    fn row(&mut self, line: &str, cells: &[Cell]) -> Result<(), RecordError>;

    /// Writes the remaining rows and returns the file.
    fn finish(self: Box<Self>) -> Result<AtomicFile, RecordError>;
}

/// A record table under construction. Dropped without [`Records::finish`] it leaves no file.
pub struct Records(Box<dyn RecordWriter>);

impl Records {
    /// Starts a file in the format given by its extension, by default as CSV.
    pub fn create(path: &Path, fields: &[Field]) -> Result<Self, RecordError> {
        let file = AtomicFile::create(path)?;
        let create = Format::of(path).ok().and_then(|format| format.records);
        Ok(Records(match create {
            Some(create) => create(file, fields)?,
            None => Box::new(CsvRecords::new(file, fields)?),
        }))
    }

    /// See [`RecordWriter::row`].
    pub fn row(&mut self, line: &str, cells: &[Cell]) -> Result<(), RecordError> {
        self.0.row(line, cells)
    }

    /// Completes the file and gives it its name.
    pub fn finish(self) -> Result<(), RecordError> {
        Ok(self.0.finish()?.finish()?)
    }
}

/// Writes records as CSV.
pub struct CsvRecords(AtomicFile);

impl CsvRecords {
    /// A file with these columns.
    pub fn new(file: AtomicFile, fields: &[Field]) -> Result<Self, RecordError> {
        let header: Vec<Cell> = fields.iter().map(|f| Cell::Text(f.name.clone())).collect();
        let mut writer = CsvRecords(file);
        writer.write_line(&line(&header))?;
        Ok(writer)
    }

    fn write_line(&mut self, line: &str) -> Result<(), RecordError> {
        let written = self.0.write_all(line.as_bytes()).and_then(|()| self.0.write_all(b"\n"));
        written.map_err(|source| self.0.failed(source).into())
    }
}

impl RecordWriter for CsvRecords {
    fn row(&mut self, line: &str, _cells: &[Cell]) -> Result<(), RecordError> {
        self.write_line(line)
    }

    fn finish(self: Box<Self>) -> Result<AtomicFile, RecordError> {
        Ok(self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_read_back_as_they_were() {
        let field = |name: &str, ty| Field {
            name: name.into(),
            ty,
            unit: String::new(),
            description: String::new(),
        };
        let fields = [
            field("n", Type::Integer),
            field("x", Type::Real),
            field("why", Type::Text),
            field("y", Type::Real),
        ];
        let cells = [
            Cell::Integer(-3),
            Cell::Real(0.1 + 0.2),
            Cell::Text("a \"b\", c".into()),
            Cell::Missing,
        ];
        let text = line(&cells);
        assert_eq!(text, "-3,0.30000000000000004,\"a \"\"b\"\", c\",");
        assert_eq!(row(&text, &fields).unwrap(), cells);
        assert!(row("1,2", &fields).is_err() && row("x,1,,", &fields).is_err());
        assert_eq!(line(&[Cell::Text("a\nb".into())]), "a b");
    }
}
