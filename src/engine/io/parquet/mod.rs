//! Results as Apache Parquet: a typed column per variable, in row groups. Sole user of `parquet`.
//!
//! Reals are DOUBLE, Booleans BOOLEAN, Integers and enumerations INT64 (mocc represents an Integer
//! by a double, which exceeds 32 bits). The metadata of the file contains JSON: `columns` with the
//! unit and description of each column, `parameters` with the values of constants. Memory use is
//! one row group, and the index of the file: some hundred bytes per column and group, written at
//! the end.
//!
//! Source: Apache Parquet format, version 2.

pub mod read;
pub mod records;

use std::fmt::Write as _;
use std::io::{self, Write};
use std::sync::Arc;

use parquet::basic::{Repetition, Type as Physical};
use parquet::column::writer::ColumnWriter;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;

use super::atomic_file::AtomicFile;
use super::csv::TableError;
use super::results::{ResultWriter, check};
use crate::ir::trajectory::{Column, Constant, Kind};

/// Number of values in a row group (64 MiB); wide tables have fewer rows per group.
const GROUP_VALUES: usize = 1 << 23;
/// Minimum and maximum number of rows in a group; with fewer rows the index outgrows the data.
const GROUP_ROWS: (usize, usize) = (512, 1 << 16);
/// Maximum size of the dictionary of a column, bytes; larger ones are not dictionary-encoded.
const DICTIONARY: usize = 1 << 16;

impl From<ParquetError> for TableError {
    fn from(error: ParquetError) -> Self {
        match error {
            ParquetError::External(inner) => match inner.downcast::<io::Error>() {
                Ok(error) => TableError::Output(*error),
                Err(other) => TableError::Output(io::Error::other(other)),
            },
            other => TableError::Output(io::Error::other(other)),
        }
    }
}

/// Writes results row by row, a group at a time.
pub struct ParquetWriter {
    out: SerializedFileWriter<AtomicFile>,
    columns: Vec<Column>,
    time: Vec<f64>,
    /// The values of the group, column by column.
    values: Vec<Vec<f64>>,
    rows_of_group: usize,
    /// Buffers for converted columns.
    whole: Vec<i64>,
    truths: Vec<bool>,
}

impl ParquetWriter {
    /// A file with these columns.
    pub fn new(out: AtomicFile, columns: &[Column]) -> Result<Self, TableError> {
        let field = |name: &str, physical| {
            let field = Type::primitive_type_builder(name, physical);
            Ok::<_, ParquetError>(Arc::new(field.with_repetition(Repetition::REQUIRED).build()?))
        };
        let mut fields = vec![field("time", Physical::DOUBLE)?];
        for column in columns {
            fields.push(field(&column.name, physical(column.kind))?);
        }
        let schema = Type::group_type_builder("run").with_fields(fields).build()?;
        let properties = WriterProperties::builder()
            .set_created_by(concat!("mocc ", env!("CARGO_PKG_VERSION")).to_owned())
            .set_statistics_enabled(EnabledStatistics::Chunk)
            .set_offset_index_disabled(true)
            .set_dictionary_page_size_limit(DICTIONARY)
            .build();
        let (least, most) = GROUP_ROWS;
        let mut writer = ParquetWriter {
            out: SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties))?,
            columns: columns.to_vec(),
            time: Vec::new(),
            values: vec![Vec::new(); columns.len()],
            rows_of_group: (GROUP_VALUES / (columns.len() + 1)).clamp(least, most),
            whole: Vec::new(),
            truths: Vec::new(),
        };
        let of = |c: &Column| (c.name.clone(), attributes(c, None));
        writer.add_metadata("columns", &columns.iter().map(of).collect::<Vec<_>>());
        Ok(writer)
    }

    /// Writes the row group.
    fn flush(&mut self) -> Result<(), TableError> {
        if self.time.is_empty() {
            return Ok(());
        }
        let mut group = self.out.next_row_group()?;
        write(&mut group, |to| match to {
            ColumnWriter::DoubleColumnWriter(to) => Ok(to.write_batch(&self.time, None, None)?),
            _ => Err(mismatch("time")),
        })?;
        for (column, values) in self.columns.iter().zip(&mut self.values) {
            write(&mut group, |to| match to {
                ColumnWriter::DoubleColumnWriter(to) => Ok(to.write_batch(values, None, None)?),
                ColumnWriter::Int64ColumnWriter(to) => {
                    self.whole.clear();
                    for (&value, &time) in values.iter().zip(&self.time) {
                        self.whole.push(whole(&column.name, value, time)?);
                    }
                    Ok(to.write_batch(&self.whole, None, None)?)
                }
                ColumnWriter::BoolColumnWriter(to) => {
                    self.truths.clear();
                    self.truths.extend(values.iter().map(|v| *v != 0.0));
                    Ok(to.write_batch(&self.truths, None, None)?)
                }
                _ => Err(mismatch(&column.name)),
            })?;
            values.clear();
        }
        group.close()?;
        self.time.clear();
        Ok(())
    }

    /// Adds an object to the metadata of the file.
    fn add_metadata(&mut self, key: &str, entries: &[(String, String)]) {
        let mut text = String::from("{");
        for (at, (name, value)) in entries.iter().enumerate() {
            text.push_str(if at == 0 { "" } else { "," });
            push_quoted(&mut text, name);
            text.push(':');
            text.push_str(value);
        }
        text.push('}');
        self.out.append_key_value_metadata(KeyValue::new(key.to_owned(), text));
    }
}

impl ResultWriter for ParquetWriter {
    fn constants(&mut self, constants: Vec<Constant>) {
        let of = |c: &Constant| (c.column.name.clone(), attributes(&c.column, Some(c.value)));
        self.add_metadata("parameters", &constants.iter().map(of).collect::<Vec<_>>());
    }

    fn row(&mut self, time: f64, values: &[f64]) -> Result<(), TableError> {
        check(&self.columns, time, values)?;
        self.time.push(time);
        self.values.iter_mut().zip(values).for_each(|(column, &value)| column.push(value));
        if self.time.len() < self.rows_of_group { Ok(()) } else { self.flush() }
    }

    fn finish(mut self: Box<Self>, _end: f64) -> Result<AtomicFile, TableError> {
        self.flush()?;
        Ok(self.out.into_inner()?)
    }
}

/// Writes the next column of a group.
fn write<W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    values: impl FnOnce(&mut ColumnWriter<'_>) -> Result<usize, TableError>,
) -> Result<(), TableError> {
    let Some(mut column) = group.next_column()? else { return Err(mismatch("the last column")) };
    values(column.untyped())?;
    Ok(column.close()?)
}

fn mismatch(name: &str) -> TableError {
    TableError::Output(io::Error::other(format!("`{name}` is not in the schema of the file")))
}

fn physical(kind: Kind) -> Physical {
    match kind {
        Kind::Continuous | Kind::Discrete => Physical::DOUBLE,
        Kind::Boolean => Physical::BOOLEAN,
        Kind::Integer => Physical::INT64,
    }
}

fn whole(name: &str, value: f64, time: f64) -> Result<i64, TableError> {
    let converted = value as i64;
    if converted as f64 == value && converted < i64::MAX {
        Ok(converted)
    } else {
        Err(TableError::NotWhole { name: name.to_owned(), value, time })
    }
}

/// Unit, description and value of a column as a JSON object.
fn attributes(column: &Column, value: Option<f64>) -> String {
    let mut text = String::from("{");
    if let Some(value) = value.filter(|v| v.is_finite()) {
        let _ = write!(text, "\"value\":{value:?}");
    }
    let texts = [
        ("unit", &column.unit),
        ("displayUnit", &column.display_unit),
        ("description", &column.description),
    ];
    for (key, value) in texts.into_iter().filter(|(_, value)| !value.is_empty()) {
        let comma = if text.len() > 1 { "," } else { "" };
        let _ = write!(text, "{comma}\"{key}\":");
        push_quoted(&mut text, value);
    }
    text.push('}');
    text
}

/// A JSON string (RFC 8259, section 7).
fn push_quoted(out: &mut String, text: &str) {
    out.push('"');
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            c if c < ' ' => {
                let _ = write!(out, "\\u{:04x}", c as u32);
            }
            c => out.push(c),
        }
    }
    out.push('"');
}

#[cfg(test)]
mod tests {
    use std::fs::File;

    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;

    use super::*;
    use crate::io::atomic_file::tests::Scratch;

    #[test]
    fn groups_types_and_metadata_read_back() {
        let dir = Scratch::new("parquet");
        let kind = |name: &str, kind| Column { kind, ..Column::new(name, "") };
        let mut x = Column::new("a.x[1,2]", "m");
        x.description = "A \"quoted\"\nplace".into();
        let columns = [x, kind("closed", Kind::Boolean), kind("n", Kind::Integer)];
        let file = AtomicFile::create(dir.path("run.parquet")).unwrap();
        let mut writer = ParquetWriter::new(file, &columns).unwrap();
        writer.constants(vec![Constant { column: Column::new("m", "kg"), value: 1e300 }]);
        writer.rows_of_group = 3;
        let rows: Vec<(f64, [f64; 3])> = (0..7)
            .map(|k| (0.125 * f64::from(k), [1.0 / f64::from(k + 1), f64::from(k % 2), -3e9]))
            .collect();
        for (time, values) in &rows {
            writer.row(*time, values).unwrap();
        }
        assert!(writer.row(1.0, &[f64::NAN, 0.0, 0.0]).is_err());
        Box::new(writer).finish(1.0).unwrap().finish().unwrap();

        let file = File::open(dir.path("run.parquet")).unwrap();
        let reader = SerializedFileReader::new(file).unwrap();
        assert_eq!(reader.num_row_groups(), 3);
        let metadata = reader.metadata().file_metadata().key_value_metadata().unwrap();
        let metadata: Vec<(&str, &str)> =
            metadata.iter().map(|k| (k.key.as_str(), k.value.as_deref().unwrap())).collect();
        assert_eq!(
            metadata,
            [
                (
                    "columns",
                    "{\"a.x[1,2]\":{\"unit\":\"m\",\"description\":\"A \\\"quoted\\\"\\u000aplace\"},\
                     \"closed\":{},\"n\":{}}"
                ),
                ("parameters", "{\"m\":{\"value\":1e300,\"unit\":\"kg\"}}"),
            ]
        );
        let mut count = 0;
        for (row, (time, values)) in reader.get_row_iter(None).unwrap().zip(&rows) {
            let row = row.unwrap();
            let fields: Vec<(&String, &Field)> = row.get_column_iter().collect();
            assert_eq!(fields[0], (&"time".to_owned(), &Field::Double(*time)));
            assert_eq!(fields[1], (&"a.x[1,2]".to_owned(), &Field::Double(values[0])));
            assert_eq!(fields[2], (&"closed".to_owned(), &Field::Bool(values[1] == 1.0)));
            assert_eq!(fields[3], (&"n".to_owned(), &Field::Long(-3_000_000_000)));
            count += 1;
        }
        assert_eq!(count, 7);
    }

    #[test]
    fn integer_columns_reject_other_numbers() {
        let dir = Scratch::new("parquet-whole");
        let column = Column { kind: Kind::Integer, ..Column::new("n", "") };
        for value in [0.5, 1e300] {
            let file = AtomicFile::create(dir.path("run.parquet")).unwrap();
            let mut writer = ParquetWriter::new(file, std::slice::from_ref(&column)).unwrap();
            writer.row(2.0, &[value]).unwrap();
            let error = Box::new(writer).finish(1.0).unwrap_err().to_string();
            assert!(error.starts_with("`n` is ") && error.contains("at time 2 s"), "{error}");
        }
        assert_eq!(dir.files(), [""; 0]);
    }
}
