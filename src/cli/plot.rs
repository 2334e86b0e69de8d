//! `mocc plot`: tables in, a chart out. Tables may be runs, sweeps or recordings.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use super::args::model::is_standard;
use super::args::results::Plot;
use super::{Status, print, print_bytes, standard_input};
use crate::driver::files;
use crate::io::format::Format;
use crate::io::records::parts;
use crate::measure::formula::{Columns, Formula};
use crate::report::chart::{Chart, Group, Series, chart, svg};

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

/// Values of the column of `--by`: each has a curve.
const MOST_GROUPS: usize = 30;
/// Panels of a picture whose columns the user has not named.
const MOST_PANELS: usize = 4;

/// The standard input, which can be read only once.
fn read_once() -> String {
    static TEXT: OnceLock<String> = OnceLock::new();
    TEXT.get_or_init(standard_input).clone()
}

/// An axis: its label, and formulas of which the first one applies whose columns the table has.
struct Shown {
    text: String,
    /// The column of this name, before all formulas.
    column: Option<String>,
    formulas: Vec<Formula>,
}

impl Shown {
    /// A column by its name.
    fn column(name: &str) -> Shown {
        Shown { text: name.to_owned(), column: Some(name.to_owned()), formulas: Vec::new() }
    }

    /// `LABEL: FORMULA | FORMULA`, the name of a column, or a formula.
    fn read(text: &str) -> Result<Shown, String> {
        let Some((name, formulas)) = text.split_once(':') else {
            let formulas = Formula::read(text).into_iter().collect();
            return Ok(Shown { formulas, ..Shown::column(text.trim()) });
        };
        let formulas = formulas.split('|').map(Formula::read).collect::<Result<_, _>>()?;
        Ok(Shown { text: name.trim().to_owned(), column: None, formulas })
    }

    fn of(&self, columns: &Columns) -> Result<Option<Vec<f64>>, String> {
        let named =
            self.column.as_ref().and_then(|name| columns.names.iter().position(|n| n == name));
        if let Some(k) = named {
            return Ok(Some(columns.values[k].clone()));
        }
        for formula in &self.formulas {
            if let Some(values) = formula.of(columns)? {
                return Ok(Some(values));
            }
        }
        Ok(None)
    }
}

fn picture(options: &Plot) -> Result<(), String> {
    let first = columns(&path_of(&options.tables[0]).0)?;
    let across = match &options.x {
        Some(text) => Shown::read(text)?,
        None => Shown::column(first.names.first().map_or("", String::as_str)),
    };
    let panels = match options.y.is_empty() {
        true => interesting(&first).iter().map(|name| Shown::column(name)).collect(),
        false => options.y.iter().map(|y| Shown::read(y)).collect::<Result<Vec<_>, _>>()?,
    };
    if panels.is_empty() {
        return Err(format!("{} has no column to draw", options.tables[0]));
    }
    let mut groups = Vec::new();
    for (k, tables) in [&options.tables, &options.beside].into_iter().enumerate() {
        if tables.is_empty() {
            continue;
        }
        let mut series: Vec<Series> = match &options.by {
            None => tables.iter().map(|t| series(t, &across, &panels)).collect::<Result<_, _>>()?,
            Some(by) => {
                let all = tables.iter().map(|t| grouped(t, by, &across, &panels));
                all.collect::<Result<Vec<_>, _>>()?.concat()
            }
        };
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
    let path = match &options.output {
        Some(path) => path.clone(),
        None => {
            let (table, _) = path_of(&options.tables[0]);
            let stem =
                table.file_stem().filter(|_| !is_standard(&table)).unwrap_or("plot".as_ref());
            PathBuf::from(stem).with_extension("svg")
        }
    };
    if is_standard(&path) {
        return print_bytes(svg(&drawn).map_err(|e| e.to_string())?.as_bytes());
    }
    chart(&drawn, &path).map_err(|e| e.to_string())?;
    if options.output.is_none() {
        print(&format!("wrote {}\n", path.display()));
    }
    Ok(())
}

/// The columns that are drawn where none are named: those of the model itself that change, the first ones.
fn interesting(table: &Columns) -> Vec<String> {
    let changes = |values: &[f64]| {
        let mut known = values.iter().filter(|v| !v.is_nan());
        known.next().is_some_and(|first| known.any(|v| v != first))
    };
    let drawn = |top: bool| -> Vec<String> {
        let all = table.names.iter().zip(&table.values).skip(1);
        let wanted = all.filter(|(name, values)| {
            name.contains('.') != top && !name.starts_with("der(") && changes(values)
        });
        wanted.map(|(name, _)| name.clone()).take(MOST_PANELS).collect()
    };
    let own = drawn(true);
    if own.is_empty() { drawn(false) } else { own }
}

/// The file and the label of `FILE` or `FILE=LABEL`.
fn path_of(table: &str) -> (PathBuf, String) {
    match table.split_once('=') {
        Some((path, label)) => (PathBuf::from(path), label.to_owned()),
        None => (PathBuf::from(table), String::new()),
    }
}

/// The curves of `FILE` or `FILE=LABEL`.
fn series(table: &str, across: &Shown, panels: &[Shown]) -> Result<Series, String> {
    let (path, label) = path_of(table);
    let columns = columns(&path)?;
    let x = across
        .of(&columns)?
        .ok_or_else(|| format!("{} has no columns for `{}`", path.display(), across.text))?;
    let y = panels.iter().map(|p| p.of(&columns)).collect::<Result<_, _>>()?;
    Ok(Series { label, x, y })
}

/// The curves of the rows that have the same value in the column `by`, in the order in which the values come.
fn grouped(table: &str, by: &str, across: &Shown, panels: &[Shown]) -> Result<Vec<Series>, String> {
    let (path, label) = path_of(table);
    let all = series(table, across, panels)?;
    let keys = texts(&path, by)?;
    let mut values: Vec<&String> = Vec::new();
    for key in &keys {
        if !values.contains(&key) {
            values.push(key);
        }
        if values.len() > MOST_GROUPS {
            let path = path.display();
            return Err(format!(
                "`{by}` has more than {MOST_GROUPS} values in {path}: a curve each"
            ));
        }
    }
    let part = |value: &String| {
        let kept = |column: &[f64]| -> Vec<f64> {
            let rows = column.iter().zip(&keys).filter(|(_, key)| *key == value);
            rows.map(|(x, _)| *x).collect()
        };
        let label = format!("{label} {by} = {value}").trim_start().to_owned();
        let y = all.y.iter().map(|column| column.as_deref().map(kept)).collect();
        Series { label, x: kept(&all.x), y }
    };
    Ok(values.into_iter().map(part).collect())
}

/// A column of a table as it is written.
fn texts(path: &Path, name: &str) -> Result<Vec<String>, String> {
    let missing = || format!("{} has no column `{name}`", path.display());
    let is_binary = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("mat") || e.eq_ignore_ascii_case("parquet"));
    if is_binary {
        let all = columns(path)?;
        let k = all.names.iter().position(|n| n == name).ok_or_else(missing)?;
        return Ok(all.values[k].iter().map(ToString::to_string).collect());
    }
    let text = if is_standard(path) { Ok(read_once()) } else { files::read(path) };
    let text = text.map_err(|e| format!("cannot read {}: {e}", path.display()))?;
    let mut lines = text.lines().filter(|line| !line.trim().is_empty());
    let names = lines.next().map(parts).unwrap_or_default();
    let k = names.iter().position(|n| n == name).ok_or_else(missing)?;
    Ok(lines
        .map(|line| parts(line).get(k).map_or(String::new(), |t| t.trim().to_owned()))
        .collect())
}

/// The columns of a table; values that are not numbers are missing.
fn columns(path: &Path) -> Result<Columns, String> {
    let is_text = path
        .extension()
        .is_none_or(|e| !e.eq_ignore_ascii_case("mat") && !e.eq_ignore_ascii_case("parquet"));
    if !is_text {
        let run = Format::read(path, &|_| true)?;
        let names =
            std::iter::once("time".to_owned()).chain(run.columns.iter().map(|c| c.name.clone()));
        let values = std::iter::once(run.time.clone()).chain(run.data.iter().map(|c| c.to_vec()));
        return Ok(Columns { names: names.collect(), values: values.collect() });
    }
    let text = if is_standard(path) { Ok(read_once()) } else { files::read(path) };
    let text = text.map_err(|e| format!("cannot read {}: {e}", path.display()))?;
    let mut lines = text.lines();
    let names = lines.next().map(parts).unwrap_or_default();
    if names.len() < 2 {
        return Err(format!(
            "{} is not a table: its first line does not name two columns or more",
            path.display()
        ));
    }
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
