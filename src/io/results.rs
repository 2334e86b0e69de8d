//! A file of results, in the format that its name asks for.
//!
//! Rows go to the file as they come. The file takes its name only at the end.

use std::path::Path;

use thiserror::Error;

use super::atomic_file::AtomicFile;
use super::csv::{TableError, TableWriter};
use super::mat4::MatWriter;
use super::parquet::ParquetWriter;
use crate::ir::trajectory::{Column, ColumnStorage, Constant};

/// The formats of results.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Format {
    /// A table as text, RFC 4180.
    Csv,
    /// Apache Parquet: columns in groups of rows, with types, units and descriptions.
    Parquet,
    /// MATLAB level 4 with the matrices that Dymola and OpenModelica write.
    Mat,
}

/// The name of a file says no format.
#[derive(Clone, PartialEq, Eq, Error, Debug)]
#[error("results can be written as .csv, .parquet or .mat, not as `{0}`")]
pub struct UnknownFormat(pub String);

impl Format {
    /// The format that the extension of `path` names, in capitals or not.
    pub fn of(path: &Path) -> Result<Format, UnknownFormat> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        match extension.as_deref() {
            Some("csv") => Ok(Format::Csv),
            Some("parquet") => Ok(Format::Parquet),
            Some("mat") => Ok(Format::Mat),
            _ => Err(UnknownFormat(path.display().to_string())),
        }
    }
}

/// A file of results under construction. Dropped without [`Results::finish`] it leaves nothing.
pub enum Results {
    /// A table as text.
    Csv(Box<TableWriter<AtomicFile>>),
    /// Columns.
    Parquet(Box<ParquetWriter>),
    /// Matrices.
    Mat(Box<MatWriter>),
}

impl Results {
    /// Begins a file at `path`; one course for each column.
    pub fn create(
        path: &Path,
        format: Format,
        columns: &[Column],
        column_storage: &[ColumnStorage],
    ) -> Result<Self, TableError> {
        let file = AtomicFile::create(path)?;
        Ok(match format {
            Format::Csv => Results::Csv(Box::new(TableWriter::new(file, columns)?)),
            Format::Parquet => Results::Parquet(Box::new(ParquetWriter::new(file, columns)?)),
            Format::Mat => Results::Mat(Box::new(MatWriter::new(file, columns, column_storage))),
        })
    }

    /// Takes parameters and constants, before the first row. Only a table as text has no place for
    /// them.
    pub fn constants(&mut self, constants: Vec<Constant>) {
        match self {
            Results::Csv(_) => {}
            Results::Parquet(writer) => writer.constants(constants),
            Results::Mat(writer) => writer.constants(constants),
        }
    }

    /// Writes one row; `values` in the order of the columns, all finite.
    pub fn row(&mut self, time: f64, values: &[f64]) -> Result<(), TableError> {
        match self {
            Results::Csv(writer) => writer.row(time, values),
            Results::Parquet(writer) => writer.row(time, values),
            Results::Mat(writer) => writer.row(time, values),
        }
    }

    /// Writes what is left and gives the file its name; `end` is the time that the run reached, s.
    pub fn finish(self, end: f64) -> Result<(), TableError> {
        let file = match self {
            Results::Csv(writer) => writer.finish()?,
            Results::Parquet(writer) => writer.finish()?,
            Results::Mat(writer) => writer.finish(end)?,
        };
        Ok(file.finish()?)
    }
}

/// Refuses a row that is not as long as the columns, or holds NaN or an infinity.
pub(crate) fn check(columns: &[Column], time: f64, values: &[f64]) -> Result<(), TableError> {
    let (found, expected) = (values.len(), columns.len());
    if found != expected {
        return Err(TableError::RowLength { found, expected, time });
    }
    let fault = |name: &str, value| TableError::NotFinite { name: name.to_owned(), value, time };
    if !time.is_finite() {
        return Err(fault("time", time));
    }
    match values.iter().position(|v| !v.is_finite()) {
        Some(at) => Err(fault(&columns[at].name, values[at])),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extension_is_the_format() {
        let of = |name: &str| Format::of(Path::new(name));
        assert_eq!(of("a/run.csv"), Ok(Format::Csv));
        assert_eq!(of("run.Parquet"), Ok(Format::Parquet));
        assert_eq!(of("x.y.MAT"), Ok(Format::Mat));
        let text = |name: &str| of(name).unwrap_err().to_string();
        assert_eq!(
            text("run.xlsx"),
            "results can be written as .csv, .parquet or .mat, not as `run.xlsx`"
        );
        assert_eq!(text("run"), "results can be written as .csv, .parquet or .mat, not as `run`");
    }

    #[test]
    fn rows_are_checked() {
        let columns = [Column::new("p", "Pa"), Column::new("v", "m/s")];
        let text = |time, values: &[f64]| check(&columns, time, values).unwrap_err().to_string();
        assert_eq!(text(0.5, &[1.0, f64::NAN]), "`v` is NaN at time 0.5 s");
        assert_eq!(text(0.5, &[1.0]), "a row at time 0.5 s has 1 values for 2 columns");
        assert_eq!(text(f64::INFINITY, &[1.0, 1.0]), "`time` is inf at time inf s");
        assert!(check(&columns, 0.5, &[1.0, 2.0]).is_ok());
    }
}
