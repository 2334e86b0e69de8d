//! `mocc plot`: tables in, a chart out. Tables may be runs, sweeps or recordings.

use std::path::{Path, PathBuf};

use super::Status;
use super::args::Plot;
use crate::driver::files;
use crate::io::records::parts;
use crate::measure::formula::{Columns, Formula};
use crate::report::chart::{Chart, Group, Series, chart};

/// Runs the command.
pub fn run(options: &Plot) -> Status {
    match picture(options) {
        Ok(()) => Status::Done,
        Err(why) => {
            eprintln!("error: {why}");
            Status::Usage
        }
    }
}

/// An axis: its label, and formulas of which the first one applies whose columns the table has.
struct Shown {
    text: String,
    formulas: Vec<Formula>,
}

impl Shown {
    /// `LABEL: FORMULA | FORMULA`
    fn read(text: &str) -> Result<Shown, String> {
        let (name, formulas) = text
            .split_once(':')
            .ok_or_else(|| format!("`{text}` has no label: write LABEL: FORMULA"))?;
        let formulas = formulas.split('|').map(Formula::read).collect::<Result<_, _>>()?;
        Ok(Shown { text: name.trim().to_owned(), formulas })
    }

    fn of(&self, columns: &Columns) -> Result<Option<Vec<f64>>, String> {
        for formula in &self.formulas {
            if let Some(values) = formula.of(columns)? {
                return Ok(Some(values));
            }
        }
        Ok(None)
    }
}

fn picture(options: &Plot) -> Result<(), String> {
    let across = Shown::read(&options.x)?;
    let panels = options.y.iter().map(|y| Shown::read(y)).collect::<Result<Vec<_>, _>>()?;
    let mut groups = Vec::new();
    for (k, tables) in [&options.tables, &options.beside].into_iter().enumerate() {
        if tables.is_empty() {
            continue;
        }
        let mut series: Vec<Series> =
            tables.iter().map(|t| series(t, &across, &panels)).collect::<Result<_, _>>()?;
        if let Some((from, to)) = options.range {
            let outside = |x: &mut f64| *x = if (from..=to).contains(x) { *x } else { f64::NAN };
            series.iter_mut().flat_map(|s| &mut s.x).for_each(outside);
        }
        let heading = options.headings.get(k).cloned().unwrap_or_default();
        groups.push(Group { heading, series });
    }
    let drawn = Chart {
        title: options.title.clone().unwrap_or_default(),
        groups,
        panels: panels.into_iter().map(|p| p.text).collect(),
        across: across.text,
        logarithmic: options.log_x,
    };
    chart(&drawn, &options.output).map_err(|e| e.to_string())
}

/// The curves of `FILE` or `FILE=LABEL`.
fn series(table: &str, across: &Shown, panels: &[Shown]) -> Result<Series, String> {
    let (path, label) = match table.split_once('=') {
        Some((path, label)) => (PathBuf::from(path), label.to_owned()),
        None => (PathBuf::from(table), String::new()),
    };
    let columns = columns(&path)?;
    let x = across
        .of(&columns)?
        .ok_or_else(|| format!("{} has no columns for `{}`", path.display(), across.text))?;
    let y = panels.iter().map(|p| p.of(&columns)).collect::<Result<_, _>>()?;
    Ok(Series { label, x, y })
}

/// The columns of a CSV file; values that are not numbers are missing.
fn columns(path: &Path) -> Result<Columns, String> {
    let text = files::read(path).map_err(|e| format!("cannot read {}: {e}", path.display()))?;
    let mut lines = text.lines();
    let names = lines.next().map(parts).unwrap_or_default();
    let mut values = vec![Vec::new(); names.len()];
    for (at, line) in lines.enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let row = parts(line);
        if row.len() != names.len() {
            let (found, expected) = (row.len(), names.len());
            return Err(format!(
                "{}:{}: {found} fields, but the header names {expected}",
                path.display(),
                at + 2
            ));
        }
        for (column, text) in values.iter_mut().zip(row) {
            column.push(text.trim().parse().unwrap_or(f64::NAN));
        }
    }
    Ok(Columns { names, values })
}
