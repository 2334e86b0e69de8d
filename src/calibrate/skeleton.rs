//! A plan for a model and a folder of recordings, guessed from the names of columns.
//!
//! *In:* a flat model, and tables with names such as `s_mm`, `p2 [bar]` or `speed_rpm`. *Out:* the text of a plan. A
//! column without a variable of its dimension becomes a comment, so the plan runs and shows what is open.

use std::fmt::Write;

use super::unit::Unit;
use crate::io::csv::TextTable;
use crate::ir::expr::{Const, Type};
use crate::ir::flat::{FlatModel, Variability, Variable};
use crate::units::dimension::Dimension;

/// A table of a folder: its name there, and its content.
pub type Table = (String, TextTable);

/// Bounds of a free parameter, as factors of its value.
const BOUNDS: (f64, f64) = (0.2, 5.0);
/// Free parameters that a plan begins with at most.
const MAX_FREE: usize = 12;

/// The text of a plan. `model` and `folder` are paths relative to it. The error is a message.
pub fn skeleton(
    flat: &FlatModel,
    model: &str,
    folder: &str,
    tables: &[Table],
) -> Result<String, String> {
    let names: Vec<&str> = tables.iter().map(|(name, _)| name.as_str()).collect();
    let experiments = tables.iter().find(|(_, table)| file_column(table, &names).is_some());
    let is_experiments = |name: &str| experiments.is_some_and(|(own, _)| own == name);
    let recordings: Vec<&Table> = tables.iter().filter(|(name, _)| !is_experiments(name)).collect();
    let Some((_, first)) = recordings.first() else {
        return Err(
            "there is no recording in this folder: a table, .csv, with names in its first line"
                .into(),
        );
    };
    let mut out = format!("model = {}\n\n[data]\nfolder = {}\n", quoted(model), quoted(folder));
    let mut used = Vec::new();
    match experiments {
        Some((name, table)) => conditions(&mut out, flat, name, table, &names, &mut used),
        None => {
            for (name, _) in &recordings {
                let _ = write!(out, "\n[[recordings]]\nfile = {}\n", quoted(name));
            }
        }
    }
    let time = time_column(first);
    let (_, unit) = split_unit(&first.names[time]);
    let unit =
        unit.filter(|(_, unit)| unit.dimension == Dimension::TIME).map_or("s".into(), |u| u.0);
    let _ = write!(
        out,
        "\n[time]\ncolumn = {}\nunit = {}\n",
        quoted(&first.names[time]),
        quoted(&unit)
    );
    let driving = inputs(&mut out, flat, first, time);
    out.push_str("\n[signals]\n");
    let is_driving = |k: usize| driving.contains(&k);
    for column in first
        .names
        .iter()
        .enumerate()
        .filter(|(k, _)| *k != time && !is_driving(*k))
        .map(|(_, name)| name)
    {
        let is_signal = |v: &Variable| {
            v.ty == Type::Real
                && v.variability == Variability::Continuous
                && !v.name.starts_with("der(")
        };
        match matched(flat, column, is_signal) {
            Some((variable, unit)) => {
                let (variable, unit) = (quoted(&variable.name), quoted(&unit));
                let _ =
                    writeln!(out, "{} = {{ variable = {variable}, unit = {unit} }}", key(column));
            }
            None => {
                let _ = writeln!(out, "# {} = {{ variable = \"?\", unit = \"?\" }}", key(column));
            }
        }
    }
    out.push_str("\n[free]\n");
    let is_free = |v: &&Variable| is_settable(v) && !used.contains(&v.name);
    let is_own = |v: &&Variable| !v.name.contains('.');
    // Those of the model itself; without any, those of its components that have values of their own.
    let has_own = flat.variables.iter().any(|v| is_free(&v) && is_own(&v));
    let free = flat.variables.iter().filter(|v| is_free(v) && (is_own(v) || !has_own));
    for (variable, value) in free.filter_map(|v| Some((v, value(flat, v)?))).take(MAX_FREE) {
        let (low, high) = (value * BOUNDS.0, value * BOUNDS.1);
        let (min, max) = (number(low.min(high)), number(low.max(high)));
        let _ = writeln!(out, "{} = {{ min = {min}, max = {max} }}", key(&variable.name));
    }
    Ok(out)
}

/// The columns that drive inputs of the model; their positions.
fn inputs(out: &mut String, flat: &FlatModel, table: &TextTable, time: usize) -> Vec<usize> {
    let is_input = |v: &Variable| v.is_open_input() && v.ty == Type::Real;
    let mut lines = String::new();
    let mut driving = Vec::new();
    for (k, column) in table.names.iter().enumerate().filter(|(k, _)| *k != time) {
        let Some((input, unit)) = matched(flat, column, is_input) else { continue };
        let interpolation = if is_held(table, k) { "hold" } else { "linear" };
        let (input, unit) = (quoted(&input.name), quoted(&unit));
        let _ = writeln!(
            lines,
            "{} = {{ input = {input}, unit = {unit}, interpolation = \"{interpolation}\" }}",
            key(column)
        );
        driving.push(k);
    }
    if !lines.is_empty() {
        let _ = write!(out, "\n[inputs]\n{lines}");
    }
    driving
}

/// True for a column that keeps its value from most rows to the next, as a digital output does.
fn is_held(table: &TextTable, column: usize) -> bool {
    let values: Vec<&str> = table.rows.iter().map(|(_, row)| row[column].as_str()).collect();
    let changes = values.windows(2).filter(|w| w[0] != w[1]).count();
    2 * changes < values.len()
}

/// The table of the recordings, and the columns of it that set parameters.
fn conditions(
    out: &mut String,
    flat: &FlatModel,
    name: &str,
    table: &TextTable,
    names: &[&str],
    used: &mut Vec<String>,
) {
    let file = file_column(table, names).unwrap_or(0);
    let _ = write!(out, "table = {}\nfile = {}\n", quoted(name), quoted(&table.names[file]));
    let values = |k: usize| table.rows.iter().map(move |(_, row)| row[k].as_str());
    let is_split = |k: &usize| values(*k).all(|v| ["train", "validation", "test"].contains(&v));
    let split = (0..table.names.len()).find(is_split);
    if let Some(k) = split {
        let _ = writeln!(out, "split = {}", quoted(&table.names[k]));
    }
    let mut lines = String::new();
    for (k, column) in table.names.iter().enumerate() {
        let is_numeric = values(k).all(|v| v.parse::<f64>().is_ok());
        if k == file || Some(k) == split || !is_numeric {
            continue;
        }
        match matched(flat, column, is_settable) {
            Some((parameter, unit)) => {
                used.push(parameter.name.clone());
                let (parameter, unit) = (quoted(&parameter.name), quoted(&unit));
                let _ = writeln!(
                    lines,
                    "{} = {{ parameter = {parameter}, unit = {unit} }}",
                    key(column)
                );
            }
            None => {
                let _ =
                    writeln!(lines, "# {} = {{ parameter = \"?\", unit = \"?\" }}", key(column));
            }
        }
    }
    if !lines.is_empty() {
        let _ = write!(out, "\n[conditions]\n{lines}");
    }
}

/// The column whose entries are names of other tables of the folder.
fn file_column(table: &TextTable, names: &[&str]) -> Option<usize> {
    let all = |k: &usize| table.rows.iter().all(|(_, row)| names.contains(&row[*k].as_str()));
    (0..table.names.len()).find(all).filter(|_| !table.rows.is_empty())
}

/// The column of the time: by its name, else the first.
fn time_column(table: &TextTable) -> usize {
    let is_time = |name: &String| {
        let (base, unit) = split_unit(name);
        let is_named = matches!(base.to_lowercase().as_str(), "t" | "time" | "zeit" | "timestamp");
        is_named && unit.is_none_or(|(_, unit)| unit.dimension == Dimension::TIME)
    };
    table.names.iter().position(is_time).unwrap_or(0)
}

/// A name without its unit, and the unit: `s_mm`, `p [bar]`, `p (bar)`, `p in bar`.
fn split_unit(name: &str) -> (String, Option<(String, Unit)>) {
    let of = |base: &str, unit: &str, read: fn(&str) -> Option<Unit>| {
        let unit = unit.trim().trim_end_matches([']', ')']).replace('_', " ");
        let found = read(&unit)?;
        let base = base.trim().trim_end_matches('_').to_owned();
        (!base.is_empty()).then_some((base, Some((unit, found))))
    };
    // From the end: the name itself may have brackets, as `tanks[1].h [cm]`.
    let inner = name.trim_end().trim_end_matches([']', ')']);
    for separator in ["[", "(", " in ", "/"] {
        let is_bracket = matches!(separator, "[" | "(");
        let whole = if is_bracket { inner } else { name };
        let parts =
            whole.rsplit_once(separator).filter(|_| !is_bracket || inner.len() < name.len());
        if let Some(found) = parts.and_then(|(base, unit)| of(base, unit, Unit::of)) {
            return found;
        }
    }
    let cuts = name.match_indices('_');
    let cuts = cuts.filter_map(|(at, _)| of(&name[..at], &name[at + 1..], Unit::of_common));
    cuts.into_iter().next().unwrap_or_else(|| (name.trim().to_owned(), None))
}

/// The variable that a column probably holds, and the unit of the column.
fn matched<'f>(
    flat: &'f FlatModel,
    column: &str,
    accepts: impl Fn(&Variable) -> bool,
) -> Option<(&'f Variable, String)> {
    let (base, unit) = split_unit(column);
    let base = base.to_lowercase();
    let mut best: Option<(u32, &Variable, String)> = None;
    for variable in flat.variables.iter().filter(|v| accepts(v)) {
        let declared = if variable.unit.is_empty() { "1" } else { &*variable.unit };
        let is_known = Unit::of(declared).is_some();
        let unit = match &unit {
            Some((name, unit)) if is_known && unit.mismatch(declared).is_none() => name.clone(),
            None if is_known => declared.to_owned(),
            _ => continue,
        };
        let rank = likeness(&base, variable);
        if rank > 0 && best.as_ref().is_none_or(|(known, ..)| rank > *known) {
            best = Some((rank, variable, unit));
        }
    }
    best.map(|(_, variable, unit)| (variable, unit))
}

/// How well the name of a column fits a variable; 0 if it does not.
fn likeness(base: &str, variable: &Variable) -> u32 {
    let name = variable.name.to_lowercase();
    let description = variable.description.as_deref().unwrap_or_default().to_lowercase();
    let last = name.rsplit('.').next().unwrap_or(&name);
    let is_own = u32::from(!name.contains('.'));
    let plain = |text: &str| text.replace(['.', '_'], "");
    let part = base.len() >= 3 && last.split('_').any(|part| part == base);
    let word = base.len() >= 3
        && description.split(|c: char| !c.is_alphanumeric()).any(|word| word == base);
    match () {
        () if name == *base => 20,
        () if plain(&name) == plain(base) => 18,
        () if last == base => 12 + is_own,
        () if part => 8 + is_own,
        () if word => 4 + is_own,
        () => 0,
    }
}

fn is_settable(v: &Variable) -> bool {
    v.ty == Type::Real && v.variability == Variability::Parameter && !v.structural && !v.protected
}

/// The value of a parameter, if it is a number other than 0.
fn value(flat: &FlatModel, variable: &Variable) -> Option<f64> {
    match flat.graph.as_const(variable.binding?)? {
        Const::Real(bits) => Some(f64::from_bits(bits)).filter(|x| *x != 0.0 && x.is_finite()),
        _ => None,
    }
}

/// Three significant digits.
fn number(x: f64) -> String {
    let near: f64 = format!("{x:.2e}").parse().unwrap_or(x);
    if (1e-3..1e5).contains(&near.abs()) { near.to_string() } else { format!("{near:e}") }
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

/// A key of TOML, in quotes if it must be.
fn key(text: &str) -> String {
    let is_bare = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-');
    if !text.is_empty() && text.chars().all(is_bare) { text.to_owned() } else { quoted(text) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_parts_of_names() {
        let of = |name: &str| {
            let (base, unit) = split_unit(name);
            (base, unit.map(|(name, _)| name).unwrap_or_default())
        };
        let expected = |base: &str, unit: &str| (base.to_owned(), unit.to_owned());
        assert_eq!(of("s_mm"), expected("s", "mm"));
        assert_eq!(of("T_b_degC"), expected("T_b", "degC"));
        assert_eq!(of("supply_bar_gauge"), expected("supply", "bar gauge"));
        assert_eq!(of("p2 [bar]"), expected("p2", "bar"));
        assert_eq!(of("flow (l/min)"), expected("flow", "l/min"));
        assert_eq!(of("stroke in mm"), expected("stroke", "mm"));
        assert_eq!(of("tanks[1].h [cm]"), expected("tanks[1].h", "cm"));
        assert_eq!(of("tanks[1].h (bar)"), expected("tanks[1].h", "bar"));
        assert_eq!(of("tanks[1].h"), expected("tanks[1].h", ""));
        assert_eq!(of("p/kPa"), expected("p", "kPa"));
        assert_eq!(of("flow [m3/s]"), expected("flow", "m3/s"));
        assert_eq!(of("height"), expected("height", ""));
    }
}
