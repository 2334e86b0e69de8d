//! Files with the results of a run.
//!
//! Rows are written as they come; the file gets its name only when it is complete. [`format`] lists
//! the formats, each with its [`ResultWriter`].
//!
//! [`format`]: super::format

use std::path::Path;

use super::atomic_file::AtomicFile;
use super::csv::TableError;
use super::format::Format;
use crate::ir::trajectory::{Column, ColumnStorage, Constant};

/// The columns of a result.
pub struct Header<'a> {
    /// The recorded variables, without the time.
    pub columns: &'a [Column],
    /// How each column is determined.
    pub column_storage: &'a [ColumnStorage],
}

/// Writes results in one format. Created with a [`Header`] by a row of
/// [`FORMATS`](super::format::FORMATS).
pub trait ResultWriter: Send {
    /// Records parameters and constants, before the first row. Formats without metadata ignore
    /// them.
    fn constants(&mut self, _constants: Vec<Constant>) {}

    /// Writes one row; `values` in the order of the columns, all finite.
    fn row(&mut self, time: f64, values: &[f64]) -> Result<(), TableError>;

    /// Writes the remaining rows and returns the file; `end` is the end of the run, s.
    fn finish(self: Box<Self>, end: f64) -> Result<AtomicFile, TableError>;
}

/// A result file under construction. Dropped without [`Results::finish`] it leaves no file.
pub struct Results(Box<dyn ResultWriter>);

impl Results {
    /// Starts a file at `path`.
    pub fn create(path: &Path, format: &Format, header: &Header<'_>) -> Result<Self, TableError> {
        Ok(Results((format.results)(AtomicFile::create(path)?, header)?))
    }

    /// See [`ResultWriter::constants`].
    pub fn constants(&mut self, constants: Vec<Constant>) {
        self.0.constants(constants);
    }

    /// See [`ResultWriter::row`].
    pub fn row(&mut self, time: f64, values: &[f64]) -> Result<(), TableError> {
        self.0.row(time, values)
    }

    /// Completes the file and gives it its name; `end` is the end of the run, s.
    pub fn finish(self, end: f64) -> Result<(), TableError> {
        Ok(self.0.finish(end)?.finish()?)
    }
}

/// Rejects a row of the wrong length, or with values that are not finite.
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
    fn rows_are_checked() {
        let columns = [Column::new("p", "Pa"), Column::new("v", "m/s")];
        let text = |time, values: &[f64]| check(&columns, time, values).unwrap_err().to_string();
        assert_eq!(text(0.5, &[1.0, f64::NAN]), "`v` is NaN at time 0.5 s");
        assert_eq!(text(0.5, &[1.0]), "a row at time 0.5 s has 1 values for 2 columns");
        assert_eq!(text(f64::INFINITY, &[1.0, 1.0]), "`time` is inf at time inf s");
        assert!(check(&columns, 0.5, &[1.0, 2.0]).is_ok());
    }
}
