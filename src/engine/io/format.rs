//! The table of result formats.
//!
//! In: the extension of an output file. Out: the writers of its format. To add a format, write its
//! [`ResultWriter`] in a file of its own and add a row to [`FORMATS`]; error messages and `--help`
//! list the formats from there.

use std::path::Path;

use thiserror::Error;

use super::atomic_file::AtomicFile;
use super::csv::{TableError, TableWriter, read_csv};
use super::mat4::MatWriter;
use super::mat4_read::read_mat;
use super::parquet::ParquetWriter;
use super::parquet::read::read_parquet;
use super::parquet::records::RecordsWriter;
use super::records::{CsvRecords, Field, RecordError, RecordWriter};
use super::results::{Header, ResultWriter};
use crate::ir::trajectory::Trajectory;

/// A file format.
pub struct Format {
    /// File name extension, lower case.
    pub extension: &'static str,
    /// Creates the writer for results of a run.
    pub results: fn(AtomicFile, &Header<'_>) -> Result<Box<dyn ResultWriter>, TableError>,
    /// Creates the writer for record tables, if the format supports them.
    pub records: Option<fn(AtomicFile, &[Field]) -> Result<Box<dyn RecordWriter>, RecordError>>,
    /// Reads the variables of a file whose names the predicate accepts; the error is a message.
    read: fn(&Path, &dyn Fn(&str) -> bool) -> Result<Trajectory, String>,
}

/// All formats; the first one is the default.
pub static FORMATS: [Format; 3] = [
    // A text table, RFC 4180.
    Format {
        extension: "csv",
        results: |file, header| {
            let table = TableWriter::new(file, header.columns)?;
            Ok(Box::new(table.with_storage(header.column_storage)))
        },
        records: Some(|file, fields| Ok(Box::new(CsvRecords::new(file, fields)?))),
        read: |path, _| read_csv(path).map_err(|e| e.to_string()),
    },
    // Apache Parquet: typed columns in row groups, with units and descriptions.
    Format {
        extension: "parquet",
        results: |file, header| Ok(Box::new(ParquetWriter::new(file, header.columns)?)),
        records: Some(|file, fields| Ok(Box::new(RecordsWriter::new(file, fields)?))),
        read: |path, wanted| read_parquet(path, wanted).map_err(|e| unreadable(path, &e)),
    },
    // MATLAB level 4 with the matrices of Dymola and OpenModelica.
    Format {
        extension: "mat",
        results: |file, header| {
            Ok(Box::new(MatWriter::new(file, header.columns, header.column_storage)))
        },
        records: None,
        read: |path, wanted| read_mat(path, wanted).map_err(|e| unreadable(path, &e)),
    },
];

/// The extension of a file name is not that of a format.
#[derive(Clone, PartialEq, Debug, Error)]
#[error("results can be written as {formats}, not as `{0}`", formats = extensions())]
pub struct UnknownFormat(pub String);

impl Format {
    /// The format given by the extension of `path`, ignoring case.
    pub fn of(path: &Path) -> Result<&'static Format, UnknownFormat> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        let found = FORMATS.iter().find(|f| extension.as_deref() == Some(f.extension));
        found.ok_or_else(|| UnknownFormat(path.display().to_string()))
    }

    /// The variables of a result file whose names `wanted` accepts. Errors: a message that names the file.
    pub fn read(path: &Path, wanted: &dyn Fn(&str) -> bool) -> Result<Trajectory, String> {
        let refused =
            |_| format!("results can be read from {}, not from `{}`", extensions(), path.display());
        (Format::of(path).map_err(refused)?.read)(path, wanted)
    }

    /// The default format.
    pub fn csv() -> &'static Format {
        &FORMATS[0]
    }
}

fn unreadable(path: &Path, why: &str) -> String {
    format!("cannot read {}: {why}", path.display())
}

/// All extensions, for messages: `.csv, .parquet or .mat`.
pub fn extensions() -> String {
    let names: Vec<String> = FORMATS.iter().map(|f| format!(".{}", f.extension)).collect();
    match names.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} or {last}", others.join(", ")),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extension_determines_the_format() {
        let of = |name: &str| Format::of(Path::new(name)).map(|f| f.extension);
        assert_eq!(of("a/run.csv"), Ok("csv"));
        assert_eq!(of("run.Parquet"), Ok("parquet"));
        assert_eq!(of("x.y.MAT"), Ok("mat"));
        let text = |name: &str| of(name).unwrap_err().to_string();
        assert_eq!(
            text("run.xlsx"),
            "results can be written as .csv, .parquet or .mat, not as `run.xlsx`"
        );
        assert_eq!(text("run"), "results can be written as .csv, .parquet or .mat, not as `run`");
    }
}
