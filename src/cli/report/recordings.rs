//! Recordings over the curves of a page.

use std::path::{Path, PathBuf};

use crate::calibrate::unit::Unit;
use crate::io::csv::{TextTable, read_text};
use crate::ir::trajectory::{Column, position};
use crate::report::page::document::Measured;

/// Which variable a column of a recording is, and its unit.
pub struct Signal {
    column: String,
    variable: String,
    unit: Unit,
}

/// Reads `COLUMN=VARIABLE:UNIT`. The error is a message.
pub fn signals(list: &[String]) -> Result<Vec<Signal>, String> {
    let one = |text: &String| {
        let (column, rest) = text
            .split_once('=')
            .ok_or_else(|| format!("the signal `{text}` has no `=`; write COLUMN=VARIABLE:UNIT"))?;
        let (variable, unit) = rest.rsplit_once(':').unwrap_or((rest, "1"));
        let found = Unit::of(unit).ok_or_else(|| format!("unknown unit `{unit}`"))?;
        let (column, variable) = (column.trim().to_owned(), variable.trim().to_owned());
        Ok(Signal { column, variable, unit: found })
    };
    list.iter().map(one).collect()
}

/// Reads the recordings; values that are not numbers are skipped.
pub fn measured(
    paths: &[PathBuf],
    signals: &[Signal],
    columns: &[Column],
) -> Result<Vec<Measured>, String> {
    let mut out = Vec::new();
    for path in paths {
        let table = read_text(path).map_err(|e| e.to_string())?;
        let time = signals.iter().find(|s| s.variable == "time");
        let (at, time_unit) = match time {
            Some(s) => (table.column(&s.column), s.unit),
            None => (Some(0), Unit::SECOND),
        };
        let at = at.ok_or_else(|| format!("{}: no column for the time", path.display()))?;
        let label = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
        for (k, variable, unit) in matched(path, &table, at, signals, columns)? {
            let pair = |row: &Vec<String>| {
                let number = |k: usize| row[k].parse::<f64>().ok().filter(|x| x.is_finite());
                Some((time_unit.to_si(number(at)?), unit.to_si(number(k)?)))
            };
            let mut pairs: Vec<(f64, f64)> =
                table.rows.iter().filter_map(|(_, row)| pair(row)).collect();
            pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (time, values) = pairs.into_iter().unzip();
            out.push(Measured { label: label.clone(), variable, time, values });
        }
    }
    Ok(out)
}

/// Columns of a recording with the variables that they measure: those of `--signal`, or those named like variables.
fn matched(
    path: &Path,
    table: &TextTable,
    time: usize,
    signals: &[Signal],
    columns: &[Column],
) -> Result<Vec<(usize, String, Unit)>, String> {
    let mut out: Vec<(usize, String, Unit)> = Vec::new();
    for s in signals.iter().filter(|s| s.variable != "time") {
        let k = table.column(&s.column).ok_or_else(|| {
            let names = table.names.join(", ");
            format!("{} has no column `{}`, only {names}", path.display(), s.column)
        })?;
        let v = position(columns, &s.variable)
            .ok_or_else(|| format!("the model has no variable `{}`", s.variable))?;
        if s.unit.mismatch(&columns[v].unit).is_some() {
            let (variable, declared) = (&s.variable, &columns[v].unit);
            return Err(format!(
                "--signal: `{variable}` is in `{declared}`, which the unit of `{}` does not measure",
                s.column
            ));
        }
        out.push((k, columns[v].name.clone(), s.unit));
    }
    if signals.iter().all(|s| s.variable == "time") {
        for (k, name) in table.names.iter().enumerate().filter(|(k, _)| *k != time) {
            if let Some(v) = position(columns, name) {
                out.push((k, columns[v].name.clone(), Unit::SECOND));
            }
        }
    }
    if out.is_empty() {
        let path = path.display();
        return Err(format!(
            "{path}: no column is named like a variable; map them with `--signal COLUMN=VARIABLE:UNIT`"
        ));
    }
    Ok(out)
}
