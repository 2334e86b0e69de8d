//! The tables of `mocc plot`: results, sweeps and recordings, in the units that the user wants.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use super::args::model::is_standard;
use super::standard_input;
use super::wanted_unit::once_each;
use crate::base::diag::did_you_mean;
use crate::driver::quantity::{conversion, scale_of};
use crate::io::number_table::NumberTable;
use crate::measure::formula::Columns;

/// A table.
pub struct Table {
    /// Its file.
    pub path: PathBuf,
    /// Its numbers.
    pub columns: Columns,
    content: NumberTable,
}

/// The standard input, which can be read only once.
fn read_once() -> String {
    static TEXT: OnceLock<String> = OnceLock::new();
    TEXT.get_or_init(standard_input).clone()
}

/// What a file is that is no table, by its extension, and what to do with it.
fn other_kind(path: &Path) -> Option<&'static str> {
    let extension = path.extension()?.to_str()?.to_ascii_lowercase();
    match extension.as_str() {
        "mo" | "mol" | "fmu" => {
            Some("it holds a model, which `mocc simulate` runs, with a table and a picture")
        }
        "toml" => Some("it holds a plan, whose results `mocc calibrate` and `diagnose` draw"),
        "svg" | "png" | "html" => Some("it holds a picture; draw the table that it is made from"),
        _ => None,
    }
}

impl Table {
    /// Reads a table, and converts columns to other units. The error is a message.
    pub fn read(path: &Path, units: &[(String, String)]) -> Result<Table, String> {
        if let Some(why) = other_kind(path) {
            return Err(format!("{} is not a table: {why}", path.display()));
        }
        let mut content = match is_standard(path) {
            true => NumberTable::of_bytes(path, read_once().as_bytes())?,
            false => NumberTable::read(path)?,
        };
        for (name, unit) in once_each(units)? {
            convert(path, &mut content, name, unit)?;
        }
        let names = content.columns.iter().map(|c| c.name.clone()).collect();
        let columns = Columns { names, values: content.data.clone() };
        Ok(Table { path: path.to_owned(), columns, content })
    }

    /// The message that the table lacks the columns of an axis.
    pub fn without(&self, text: &str) -> String {
        let near = did_you_mean(text, self.columns.names.iter().map(String::as_str));
        let near = near.map_or(String::new(), |near| format!("; did you mean `{near}`?"));
        format!("{} has no columns for `{text}`{near}", self.path.display())
    }

    /// A column as text. The error is a message.
    pub fn texts(&self, name: &str) -> Result<Vec<String>, String> {
        let k = self.content.position(name);
        let k = k.ok_or_else(|| format!("{} has no column `{name}`", self.path.display()))?;
        Ok(self.content.texts(k))
    }

    /// The label of an axis: a column with its unit, if the file says it; another text as it is.
    pub fn labelled(&self, text: String) -> String {
        let known = self.content.columns.iter().find(|c| c.name == text);
        match known.filter(|c| !c.unit.is_empty() && c.unit != "1") {
            Some(column) => format!("{text} in {}", column.unit),
            None => text,
        }
    }
}

fn convert(path: &Path, table: &mut NumberTable, name: &str, unit: &str) -> Result<(), String> {
    let shown = path.display();
    scale_of(unit).ok_or_else(|| format!("--unit: `{unit}` is not a known unit"))?;
    let k =
        table.position(name).ok_or_else(|| format!("--unit: {shown} has no column `{name}`"))?;
    let own = table.columns[k].unit.clone();
    if own.is_empty() {
        return Err(format!(
            "--unit: {shown} does not say in which unit `{name}` is; .parquet and .mat files of results do, or write a formula"
        ));
    }
    let conversion = conversion(&own, unit).ok_or_else(|| {
        format!("--unit: `{name}` is in `{own}`, which `{unit}` does not measure")
    })?;
    table.data[k].iter_mut().for_each(|value| *value = conversion.of(*value));
    table.columns[k].unit = unit.to_owned();
    Ok(())
}
