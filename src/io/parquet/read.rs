//! Reads results from Parquet files of any writer: a column of numbers or Booleans per variable.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;

use crate::ir::trajectory::{Column, Trajectory};

/// The variables of a file whose names `wanted` accepts. The time is the column `time` or, without one, the first. The
/// error is a message without the name of the file.
pub fn read_parquet(path: &Path, wanted: &dyn Fn(&str) -> bool) -> Result<Trajectory, String> {
    let file = File::open(path).map_err(|e| e.to_string())?;
    let reader = SerializedFileReader::new(file).map_err(|e| e.to_string())?;
    let fields = reader.metadata().file_metadata().schema().get_fields();
    let names: Vec<String> = fields.iter().map(|f| f.name().to_owned()).collect();
    let time = names.iter().position(|n| matches!(n.as_str(), "time" | "Time")).unwrap_or(0);
    let mut columns: Vec<Vec<f64>> = vec![Vec::new(); names.len()];
    for row in reader.get_row_iter(None).map_err(|e| e.to_string())? {
        let row = row.map_err(|e| e.to_string())?;
        for (k, (_, field)) in row.get_column_iter().enumerate() {
            columns[k].push(number(field));
        }
    }
    let mut out = Trajectory::default();
    for (k, (name, values)) in names.into_iter().zip(columns).enumerate() {
        if k == time {
            out.time = values;
        } else if wanted(&name) && values.iter().any(|v| !v.is_nan()) {
            out.columns.push(Column::new(name, ""));
            out.data.push(Arc::new(values));
        }
    }
    out.verify().map_err(|fault| fault.to_string())?;
    Ok(out)
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
