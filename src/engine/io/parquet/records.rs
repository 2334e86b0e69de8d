//! Record tables as Parquet: optional columns, with units in the metadata `columns`.

use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::column::writer::ColumnWriter;
use parquet::data_type::ByteArray;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type as Schema;

use super::{attributes, mismatch, push_quoted};
use crate::io::atomic_file::AtomicFile;
use crate::io::csv::TableError;
use crate::io::records::{Cell, Field, RecordError, RecordWriter, Type};
use crate::ir::trajectory::Column;

/// Number of rows in a group.
const GROUP_ROWS: usize = 1 << 14;

/// Writes rows, a group at a time.
pub struct RecordsWriter {
    out: SerializedFileWriter<AtomicFile>,
    fields: Vec<Field>,
    /// The values of the group, column by column.
    cells: Vec<Vec<Cell>>,
}

impl RecordsWriter {
    /// A file with these columns.
    pub fn new(out: AtomicFile, fields: &[Field]) -> Result<Self, TableError> {
        let field = |field: &Field| {
            let physical = match field.ty {
                Type::Real => Physical::DOUBLE,
                Type::Integer => Physical::INT64,
                Type::Text => Physical::BYTE_ARRAY,
            };
            let text = (field.ty == Type::Text).then_some(LogicalType::String);
            let builder = Schema::primitive_type_builder(&field.name, physical)
                .with_repetition(Repetition::OPTIONAL)
                .with_logical_type(text);
            Ok::<_, ParquetError>(Arc::new(builder.build()?))
        };
        let columns = fields.iter().map(field).collect::<Result<Vec<_>, _>>()?;
        let schema = Schema::group_type_builder("sweep").with_fields(columns).build()?;
        let properties = WriterProperties::builder()
            .set_created_by(concat!("mocc ", env!("CARGO_PKG_VERSION")).to_owned())
            .build();
        let out = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties))?;
        let mut text = String::from("{");
        for (at, field) in fields.iter().enumerate() {
            text.push_str(if at == 0 { "" } else { "," });
            push_quoted(&mut text, &field.name);
            text.push(':');
            let column = Column::new(field.name.clone(), field.unit.clone());
            let column = Column { description: field.description.clone(), ..column };
            text.push_str(&attributes(&column, None));
        }
        text.push('}');
        let mut writer =
            RecordsWriter { out, fields: fields.to_vec(), cells: vec![Vec::new(); fields.len()] };
        writer.out.append_key_value_metadata(KeyValue::new("columns".to_owned(), text));
        Ok(writer)
    }

    fn flush(&mut self) -> Result<(), TableError> {
        if self.cells.first().is_none_or(Vec::is_empty) {
            return Ok(());
        }
        let mut group = self.out.next_row_group()?;
        for (field, cells) in self.fields.iter().zip(&mut self.cells) {
            // Definition level: 1 for a value, 0 for a missing one.
            let levels: Vec<i16> = cells.iter().map(|c| i16::from(*c != Cell::Missing)).collect();
            let levels = Some(levels.as_slice());
            let Some(mut column) = group.next_column()? else { return Err(mismatch(&field.name)) };
            match column.untyped() {
                ColumnWriter::DoubleColumnWriter(to) => {
                    let of = |c: &Cell| if let Cell::Real(x) = c { Some(*x) } else { None };
                    let values: Vec<f64> = cells.iter().filter_map(of).collect();
                    to.write_batch(&values, levels, None)?;
                }
                ColumnWriter::Int64ColumnWriter(to) => {
                    let of = |c: &Cell| if let Cell::Integer(n) = c { Some(*n) } else { None };
                    let values: Vec<i64> = cells.iter().filter_map(of).collect();
                    to.write_batch(&values, levels, None)?;
                }
                ColumnWriter::ByteArrayColumnWriter(to) => {
                    let of = |c: &Cell| {
                        if let Cell::Text(t) = c { Some(t.as_str().into()) } else { None }
                    };
                    let values: Vec<ByteArray> = cells.iter().filter_map(of).collect();
                    to.write_batch(&values, levels, None)?;
                }
                _ => return Err(mismatch(&field.name)),
            }
            column.close()?;
            cells.clear();
        }
        group.close()?;
        Ok(())
    }
}

impl RecordWriter for RecordsWriter {
    fn row(&mut self, _line: &str, cells: &[Cell]) -> Result<(), RecordError> {
        self.cells.iter_mut().zip(cells).for_each(|(column, cell)| column.push(cell.clone()));
        let full = self.cells.first().is_some_and(|c| c.len() >= GROUP_ROWS);
        if full { Ok(self.flush()?) } else { Ok(()) }
    }

    fn finish(mut self: Box<Self>) -> Result<AtomicFile, RecordError> {
        self.flush()?;
        Ok(self.out.into_inner().map_err(TableError::from)?)
    }
}

#[cfg(test)]
mod tests {
    use std::fs::File;

    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field as Read;

    use super::*;
    use crate::io::atomic_file::tests::Scratch;

    #[test]
    fn rows_with_missing_values_read_back() {
        let dir = Scratch::new("records");
        let field = |name: &str, ty, unit: &str| Field {
            name: name.into(),
            ty,
            unit: unit.into(),
            description: String::new(),
        };
        let fields = [
            field("run", Type::Integer, ""),
            field("t", Type::Real, "s"),
            field("error", Type::Text, ""),
        ];
        let file = AtomicFile::create(dir.path("sweep.parquet")).unwrap();
        let mut writer = RecordsWriter::new(file, &fields).unwrap();
        writer.row("", &[Cell::Integer(1), Cell::Real(0.25), Cell::Missing]).unwrap();
        writer.row("", &[Cell::Integer(2), Cell::Missing, Cell::Text("Ä, b".into())]).unwrap();
        Box::new(writer).finish().unwrap().finish().unwrap();

        let reader = SerializedFileReader::new(File::open(dir.path("sweep.parquet")).unwrap());
        let reader = reader.unwrap();
        let metadata = reader.metadata().file_metadata().key_value_metadata().unwrap();
        let columns = "{\"run\":{},\"t\":{\"unit\":\"s\"},\"error\":{}}";
        assert_eq!(metadata[0].value.as_deref(), Some(columns));
        let rows: Vec<Vec<Read>> = reader
            .get_row_iter(None)
            .unwrap()
            .map(|row| row.unwrap().get_column_iter().map(|(_, value)| value.clone()).collect())
            .collect();
        let expected = [
            vec![Read::Long(1), Read::Double(0.25), Read::Null],
            vec![Read::Long(2), Read::Null, Read::Str("Ä, b".into())],
        ];
        assert_eq!(rows, expected);
    }
}
