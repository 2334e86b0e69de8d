//! Columns of numbers of a table in any format, with their units: results, sweeps and recordings, whatever their order.

use std::path::Path;

use super::csv::{ReadError, TextTable, read_text, table_of};
use super::format::Format;
use super::parquet::read::read_columns;
use crate::ir::trajectory::Column;

/// A table of numbers.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct NumberTable {
    /// Names, with units where the file has them.
    pub columns: Vec<Column>,
    /// Values of each column; NaN where there is no number.
    pub data: Vec<Vec<f64>>,
    /// The fields as they are written, for a table of text.
    pub text: Option<TextTable>,
}

impl NumberTable {
    /// Reads a file. Errors: a message that names it.
    pub fn read(path: &Path) -> Result<NumberTable, String> {
        let named = |why: String| format!("cannot read {}: {why}", path.display());
        match extension(path).as_str() {
            "parquet" => {
                let (columns, data) = read_columns(path).map_err(named)?;
                Ok(NumberTable { columns, data, text: None })
            }
            "mat" => {
                let run = Format::read(path, &|_| true)?;
                let columns = [Column::new("time", "s")].into_iter().chain(run.columns);
                let data = run.data.iter().map(|values| values.to_vec());
                let data = std::iter::once(run.time).chain(data).collect();
                Ok(NumberTable { columns: columns.collect(), data, text: None })
            }
            _ => read_text(path).and_then(|table| of_text(path, table)).map_err(|e| e.to_string()),
        }
    }

    /// A table of text, which `path` names in messages.
    pub fn of_bytes(path: &Path, bytes: &[u8]) -> Result<NumberTable, String> {
        table_of(path, bytes).and_then(|table| of_text(path, table)).map_err(|e| e.to_string())
    }

    /// Position of a column.
    pub fn position(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|c| c.name == name)
    }

    /// A column as text: as it is written in the file, or the shortest text of each number.
    pub fn texts(&self, k: usize) -> Vec<String> {
        match &self.text {
            Some(table) => table.rows.iter().map(|(_, row)| row[k].clone()).collect(),
            None => self.data[k].iter().map(ToString::to_string).collect(),
        }
    }
}

fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

fn of_text(path: &Path, table: TextTable) -> Result<NumberTable, ReadError> {
    if table.names.len() < 2 {
        return Err(ReadError::OneColumn { path: path.to_owned() });
    }
    let value = |text: &String| text.parse().ok().filter(|x: &f64| x.is_finite());
    let column = |k: usize| -> Vec<f64> {
        table.rows.iter().map(|(_, row)| value(&row[k]).unwrap_or(f64::NAN)).collect()
    };
    Ok(NumberTable {
        columns: table.names.iter().map(|name| Column::new(name.as_str(), "")).collect(),
        data: (0..table.names.len()).map(column).collect(),
        text: Some(table),
    })
}
