//! Texts, tables and recordings that a front end holds in memory. Each takes the place of a file that the plan names.

use std::path::{Path, PathBuf};

use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::driver::packed::Packed;
use crate::io::csv::{ReadError, TextTable, read_text, table_of};

use super::cause::RecordingCause;
use super::elsewhere::Way;
use super::plan::Plan;

/// All of them; empty if everything is read from files.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Memory {
    /// The text of the plan.
    pub plan: Option<String>,
    /// The text of the model's file.
    pub model: Option<String>,
    /// The table of recordings.
    pub table: Option<TextTable>,
    /// Recordings, by the names of the files that they take the place of.
    pub recordings: Vec<(String, NumberTable)>,
    /// Tables of strings as the bytes of their files, by the paths of these.
    pub files: Vec<(PathBuf, Vec<u8>)>,
    /// Folders of libraries and effects.
    pub packed: Packed,
    /// FMUs, or folders with FMUs, that the user allows to run: foreign code, which a plan may name.
    pub fmus: Vec<PathBuf>,
    /// Other processes that do the runs.
    pub elsewhere: Way,
}

/// Columns of numbers; NaN where there is none.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct NumberTable {
    /// Names of the columns, all different.
    pub names: Vec<String>,
    /// The columns, all of the same length.
    pub columns: Vec<Vec<f64>>,
}

/// The rows of a recording, from a file or from memory.
pub enum Rows<'a> {
    /// From a file.
    Text(TextTable),
    /// From memory.
    Numbers(&'a NumberTable),
}

impl Memory {
    /// The rows of a recording with its name for messages. Errors: the file cannot be read.
    pub fn rows<'a>(&'a self, plan: &Plan, file: &str) -> (PathBuf, Result<Rows<'a>, Diagnostic>) {
        if let Some((_, found)) = self.recordings.iter().find(|(name, _)| name == file) {
            return (PathBuf::from(file), Ok(Rows::Numbers(found)));
        }
        let path = plan.folder.join(file);
        let read = self.text(&path).map(Rows::Text).map_err(|why| unreadable(&why, false));
        (path, read)
    }

    /// The table of recordings with its name for messages. Errors: the file cannot be read.
    pub fn table(&self, plan: &Plan) -> (PathBuf, Result<TextTable, Diagnostic>) {
        if let Some(table) = &self.table {
            return (PathBuf::from(&plan.table), Ok(table.clone()));
        }
        let path = plan.folder.join(&plan.table);
        let read = self.text(&path).map_err(|why| unreadable(&why, true));
        (path, read)
    }

    /// A table of strings, from memory or from a file.
    fn text(&self, path: &Path) -> Result<TextTable, ReadError> {
        match self.files.iter().find(|(known, _)| known == path) {
            Some((_, bytes)) => table_of(path, bytes),
            None => read_text(path),
        }
    }
}

impl Rows<'_> {
    /// Names of the columns.
    pub fn names(&self) -> &[String] {
        match self {
            Rows::Text(table) => &table.names,
            Rows::Numbers(table) => &table.names,
        }
    }

    /// Number of rows.
    pub fn count(&self) -> usize {
        match self {
            Rows::Text(table) => table.rows.len(),
            Rows::Numbers(table) => table.columns.first().map_or(0, Vec::len),
        }
    }

    /// The line of a row in its file, or its number, both from 1.
    pub fn line(&self, row: usize) -> u64 {
        match self {
            Rows::Text(table) => table.rows[row].0,
            Rows::Numbers(_) => row as u64 + 1,
        }
    }

    /// A value; `None` if it is not a finite number.
    pub fn number(&self, row: usize, column: usize) -> Option<f64> {
        let value = match self {
            Rows::Text(table) => table.rows[row].1[column].parse::<f64>().ok(),
            Rows::Numbers(table) => Some(table.columns[column][row]),
        };
        value.filter(|x| x.is_finite())
    }
}

fn unreadable(why: &ReadError, is_table: bool) -> Diagnostic {
    Diagnostic::new(RecordingCause::Unreadable { why: why.to_string(), is_table }, Span::NONE)
}
