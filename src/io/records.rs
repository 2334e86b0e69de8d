//! Tables without a time: rows of numbers and texts, some of which may be missing, as CSV or Parquet.

use std::io::Write;
use std::path::Path;

use thiserror::Error;

use super::atomic_file::{AtomicFile, WriteError};
use super::csv::{TableError, push_number, push_quoted};
use super::parquet::records::RecordsWriter;

/// What a column holds.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Type {
    /// Numbers.
    Real,
    /// Whole numbers.
    Whole,
    /// Texts.
    Text,
}

/// A column.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Field {
    /// Its name.
    pub name: String,
    /// What it holds.
    pub ty: Type,
    /// SI unit; may be empty.
    pub unit: String,
    /// What it means; may be empty.
    pub description: String,
}

/// A value; columns of numbers hold no texts and the other way round.
#[derive(Clone, PartialEq, Debug)]
pub enum Cell {
    /// There is none.
    Missing,
    /// A finite number.
    Real(f64),
    /// A whole number.
    Whole(i64),
    /// A text.
    Text(String),
}

/// Why a table was not written.
#[derive(Error, Debug)]
pub enum RecordError {
    /// What was read back is no row of this table.
    #[error("a line of the journal is broken: `{0}`; begin anew with `--restart`")]
    Broken(String),
    /// The output took no more.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The file could not be made.
    #[error(transparent)]
    File(#[from] WriteError),
}

/// A row as a line of CSV (RFC 4180) without its end. Texts have no line breaks in it. Numbers read back as
/// they were.
pub fn line(cells: &[Cell]) -> String {
    let mut text = Vec::new();
    for (i, cell) in cells.iter().enumerate() {
        if i > 0 {
            text.push(b',');
        }
        match cell {
            Cell::Missing => {}
            Cell::Real(x) => push_number(&mut text, *x, false),
            Cell::Whole(n) => text.extend_from_slice(n.to_string().as_bytes()),
            Cell::Text(t) => {
                let mut quoted = String::new();
                push_quoted(&mut quoted, &t.replace(['\n', '\r'], " "));
                text.extend_from_slice(quoted.as_bytes());
            }
        }
    }
    String::from_utf8(text).unwrap_or_default()
}

/// The row that a line holds.
pub fn row(line: &str, fields: &[Field]) -> Result<Vec<Cell>, RecordError> {
    let broken = || RecordError::Broken(line.to_owned());
    let texts = parts(line);
    if texts.len() != fields.len() {
        return Err(broken());
    }
    let cell = |(text, field): (String, &Field)| match field.ty {
        _ if text.is_empty() => Ok(Cell::Missing),
        Type::Real => text.parse().map(Cell::Real).map_err(|_| broken()),
        Type::Whole => text.parse().map(Cell::Whole).map_err(|_| broken()),
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

/// A table under construction. Dropped without [`Records::finish`] it leaves nothing.
pub enum Records {
    /// As text.
    Csv(Box<AtomicFile>),
    /// As columns.
    Parquet(Box<RecordsWriter>),
}

impl Records {
    /// Begins a file, as Parquet if its name ends so.
    pub fn create(path: &Path, fields: &[Field]) -> Result<Self, RecordError> {
        let mut file = AtomicFile::create(path)?;
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        if extension.as_deref() == Some("parquet") {
            return Ok(Records::Parquet(Box::new(RecordsWriter::new(file, fields)?)));
        }
        let header: Vec<Cell> = fields.iter().map(|f| Cell::Text(f.name.clone())).collect();
        put(&mut file, &line(&header))?;
        Ok(Records::Csv(Box::new(file)))
    }

    /// Writes a row, given as a line of CSV and as cells.
    pub fn row(&mut self, text: &str, cells: &[Cell]) -> Result<(), RecordError> {
        match self {
            Records::Csv(file) => put(file, text),
            Records::Parquet(writer) => Ok(writer.row(cells)?),
        }
    }

    /// Gives the file its name.
    pub fn finish(self) -> Result<(), RecordError> {
        let file = match self {
            Records::Csv(file) => *file,
            Records::Parquet(writer) => writer.finish()?,
        };
        Ok(file.finish()?)
    }
}

fn put(file: &mut AtomicFile, line: &str) -> Result<(), RecordError> {
    let written = file.write_all(line.as_bytes()).and_then(|()| file.write_all(b"\n"));
    written.map_err(|source| file.failed(source).into())
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
            field("n", Type::Whole),
            field("x", Type::Real),
            field("why", Type::Text),
            field("y", Type::Real),
        ];
        let cells = [
            Cell::Whole(-3),
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
