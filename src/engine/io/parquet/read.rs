//! Reads results from Parquet files of any writer: a column of numbers or Booleans per variable.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;

use crate::io::json::Json;
use crate::ir::trajectory::{Column, Trajectory};

/// The variables of a file whose names `wanted` accepts. The time is the column `time` or, without one, the first. The
/// error is a message without the name of the file.
pub fn read_parquet(path: &Path, wanted: &dyn Fn(&str) -> bool) -> Result<Trajectory, String> {
    let (columns, data) = read_columns(path)?;
    let is_time = |c: &Column| matches!(c.name.as_str(), "time" | "Time");
    let time = columns.iter().position(is_time).unwrap_or(0);
    let mut out = Trajectory::default();
    for (k, (column, values)) in columns.into_iter().zip(data).enumerate() {
        if k == time {
            out.time = values;
        } else if wanted(&column.name) && values.iter().any(|v| !v.is_nan()) {
            out.columns.push(column);
            out.data.push(Arc::new(values));
        }
    }
    out.verify().map_err(|fault| fault.to_string())?;
    Ok(out)
}

/// All columns of a file in their order, with the units that its metadata gives, and their numbers. The error is a message
/// without the name of the file.
pub fn read_columns(path: &Path) -> Result<(Vec<Column>, Vec<Vec<f64>>), String> {
    let file = File::open(path).map_err(|e| e.to_string())?;
    let reader = SerializedFileReader::new(file).map_err(|e| e.to_string())?;
    let metadata = reader.metadata().file_metadata();
    let entries = metadata.key_value_metadata().into_iter().flatten();
    let described = entries.filter(|e| e.key == "columns").find_map(|e| e.value.as_deref());
    let described = described.and_then(|text| Json::parse(text).ok()).unwrap_or_else(Json::null);
    let column = |name: &str| {
        let known = described.text_at(&[name, "unit"]).unwrap_or_default();
        let unit = if known.is_empty() && name == "time" { "s" } else { known };
        Column::new(name, unit)
    };
    let columns: Vec<Column> =
        metadata.schema().get_fields().iter().map(|f| column(f.name())).collect();
    let mut data: Vec<Vec<f64>> = vec![Vec::new(); columns.len()];
    for row in reader.get_row_iter(None).map_err(|e| e.to_string())? {
        let row = row.map_err(|e| e.to_string())?;
        for (k, (_, field)) in row.get_column_iter().enumerate() {
            data[k].push(number(field));
        }
    }
    Ok((columns, data))
}

/// The number in a field; NaN for strings, dates and missing values.
fn number(field: &Field) -> f64 {
    match field {
        Field::Bool(b) => f64::from(*b),
        Field::Byte(x) => f64::from(*x),
        Field::Short(x) => f64::from(*x),
        Field::Int(x) => f64::from(*x),
        Field::Long(x) => *x as f64,
        Field::UByte(x) => f64::from(*x),
        Field::UShort(x) => f64::from(*x),
        Field::UInt(x) => f64::from(*x),
        Field::ULong(x) => *x as f64,
        Field::Float(x) => f64::from(*x),
        Field::Double(x) => *x,
        _ => f64::NAN,
    }
}
