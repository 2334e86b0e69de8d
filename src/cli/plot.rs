//! `mocc plot`: tables in, a chart out. Tables may be runs, sweeps or recordings.

use std::path::PathBuf;

use super::args::model::is_standard;
use super::args::results::Plot;
use super::plot_table::Table;
use super::{Status, print, print_bytes};
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
            if text.trim().is_empty() {
                return Err("an axis needs a column or a formula".to_owned());
            }
            // The name of a column need not be a formula.
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
    let read = |tables: &[String]| -> Result<Vec<(Table, String)>, String> {
        let one = |table: &String| {
            let (path, label) = path_of(table);
            Ok((Table::read(&path, &options.units)?, label))
        };
        tables.iter().map(one).collect()
    };
    let (tables, beside) = (read(&options.tables)?, read(&options.beside)?);
    let first = &tables[0].0;
    let across = match &options.x {
        Some(text) => Shown::read(text)?,
        None => Shown::column(first.columns.names.first().map_or("", String::as_str)),
    };
    let panels = match options.y.is_empty() {
        true => interesting(&first.columns).iter().map(|name| Shown::column(name)).collect(),
        false => options.y.iter().map(|y| Shown::read(y)).collect::<Result<Vec<_>, _>>()?,
    };
    if panels.is_empty() {
        return Err(format!("{} has no column to draw", options.tables[0]));
    }
    let mut groups = Vec::new();
    for (k, tables) in [&tables, &beside].into_iter().enumerate() {
        if tables.is_empty() {
            continue;
        }
        let curves = |(table, label): &(Table, String)| match &options.by {
            None => Ok(vec![series(table, label, &across, &panels)?]),
            Some(by) => grouped(table, label, by, &across, &panels),
        };
        let mut series = tables.iter().map(curves).collect::<Result<Vec<_>, String>>()?.concat();
        if let Some((from, to)) = options.range {
            let outside = |x: &mut f64| *x = if (from..=to).contains(x) { *x } else { f64::NAN };
            series.iter_mut().flat_map(|s| &mut s.x).for_each(outside);
        }
        let heading = options.headings.get(k).cloned().unwrap_or_default();
        groups.push(Group { heading, series });
    }
    checked(&groups, &panels, first, options)?;
    let drawn = Chart {
        title: options.title.clone().unwrap_or_default(),
        groups,
        panels: panels.into_iter().map(|p| first.labelled(p.text)).collect(),
        across: first.labelled(across.text),
        logarithmic: options.log_x,
    };
    finish(options, &drawn)
}

/// Each panel must have a point; the error says which one has none, and why.
fn checked(
    groups: &[Group],
    panels: &[Shown],
    first: &Table,
    options: &Plot,
) -> Result<(), String> {
    let all = || groups.iter().flat_map(|g| &g.series);
    let is_drawn = |x: &f64| x.is_finite() && (!options.log_x || *x > 0.0);
    if !all().flat_map(|s| &s.x).any(is_drawn) {
        return Err(match options.range {
            Some((from, to)) => format!("no row is within the range {from}:{to}"),
            None => format!("{} has no numbers for the horizontal axis", first.path.display()),
        });
    }
    for (k, panel) in panels.iter().enumerate() {
        if all().all(|s| s.y[k].is_none()) {
            return Err(first.without(&panel.text));
        }
        let values = |s: &Series| {
            let pairs = s.x.iter().zip(s.y[k].iter().flatten());
            pairs.filter(|(x, y)| is_drawn(x) && y.is_finite()).count()
        };
        if all().map(values).sum::<usize>() == 0 {
            return Err(format!("`{}` has no numbers to draw", panel.text));
        }
    }
    Ok(())
}

/// Writes the picture where it is wanted.
fn finish(options: &Plot, drawn: &Chart) -> Result<(), String> {
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
        return print_bytes(svg(drawn).map_err(|e| e.to_string())?.as_bytes());
    }
    chart(drawn, &path).map_err(|e| e.to_string())?;
    print(&format!("wrote {}\n", path.display()));
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
fn series(table: &Table, label: &str, across: &Shown, panels: &[Shown]) -> Result<Series, String> {
    let columns = &table.columns;
    let x = across.of(columns)?.ok_or_else(|| table.without(&across.text))?;
    let y = panels.iter().map(|p| p.of(columns)).collect::<Result<_, _>>()?;
    Ok(Series { label: label.to_owned(), x, y })
}

/// The curves of the rows that have the same value in the column `by`, in the order in which the values come.
fn grouped(
    table: &Table,
    label: &str,
    by: &str,
    across: &Shown,
    panels: &[Shown],
) -> Result<Vec<Series>, String> {
    let all = series(table, label, across, panels)?;
    let keys = table.texts(by)?;
    let mut values: Vec<&String> = Vec::new();
    for key in &keys {
        if !values.contains(&key) {
            values.push(key);
        }
        if values.len() > MOST_GROUPS {
            let path = table.path.display();
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
        let shown = value.strip_suffix(".0").unwrap_or(value);
        let label = format!("{label} {by} = {shown}").trim_start().to_owned();
        let y = all.y.iter().map(|column| column.as_deref().map(kept)).collect();
        Series { label, x: kept(&all.x), y }
    };
    Ok(values.into_iter().map(part).collect())
}
