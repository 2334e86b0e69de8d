//! Specification of a plot, and plotting errors.

use std::path::PathBuf;

use thiserror::Error;

use crate::base::diag::did_you_mean;
use crate::io::atomic_file::WriteError;
use crate::ir::trajectory::{Column, Fault, Kind, position};
use crate::report::scale;

/// Specification of a plot.
#[derive(Clone, PartialEq, Debug)]
pub struct PlotSpec {
    /// Title; may be empty.
    pub title: String,
    /// Panels from top to bottom.
    pub panels: Vec<Panel>,
    /// Width, px; a PNG has [`PNG_SCALE`](super::PNG_SCALE) pixels for each.
    pub width: u32,
    /// Height, px; a PNG has [`PNG_SCALE`](super::PNG_SCALE) pixels for each.
    pub height: u32,
    /// Mark events by faint vertical lines.
    pub events: bool,
}

/// Curves over one vertical axis.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Panel {
    /// Names of the columns, all with the same unit; spaces are ignored.
    pub curves: Vec<String>,
    /// The quantity, such as `pressure`; the unit is added. May be empty.
    pub label: String,
}

/// Why a plot could not be drawn.
#[derive(Error, Debug)]
pub enum PlotError {
    /// There is no such column.
    #[error("there is no variable `{name}` in the result{}", suggestion(near))]
    UnknownCurve {
        /// The requested name.
        name: String,
        /// A column with a similar name.
        near: Option<String>,
    },
    /// Two curves of one panel have different units.
    #[error("`{}` in {} and `{}` in {} cannot share one axis", first.0, unit(&first.1), second.0, unit(&second.1))]
    MixedUnits {
        /// Name and unit of one curve.
        first: (String, String),
        /// Name and unit of another.
        second: (String, String),
    },
    /// No panel, a panel without curves, or a result without rows.
    #[error("nothing to plot: {0}")]
    Empty(&'static str),
    /// The panels do not fit.
    #[error(
        "{width} x {height} px is too small for this picture; it needs {needed} px of height and some 250 px of width"
    )]
    TooSmall {
        /// Requested width, px.
        width: u32,
        /// Requested height, px.
        height: u32,
        /// Minimum height at this width, px.
        needed: u32,
    },
    /// Larger than viewers or the memory can handle.
    #[error("{width} x {height} px is too large for a picture")]
    TooLarge {
        /// Requested width, px.
        width: u32,
        /// Requested height, px.
        height: u32,
    },
    /// The extension of the file is not that of a picture format.
    #[error("{}: a picture's name ends in .svg or .png", path.display())]
    Extension {
        /// The file.
        path: PathBuf,
    },
    /// The result violates its invariants, which is a bug.
    #[error("the result is broken: {0}")]
    Broken(#[from] Fault),
    /// The picture could not be drawn, which is a bug.
    #[error("the picture could not be drawn: {0}")]
    Drawing(String),
    /// The file could not be written.
    #[error(transparent)]
    File(#[from] WriteError),
}

impl PlotSpec {
    /// A plot of the default size: 960 px wide, as high as the panels need.
    pub fn new(title: impl Into<String>, panels: Vec<Panel>) -> Self {
        let height = 110 + 190 * panels.len() as u32;
        PlotSpec { title: title.into(), panels, width: 960, height, events: false }
    }
}

/// Groups variables into one panel per unit, in order of the first occurrence of each unit.
/// Booleans, Integers and Reals never share a panel.
pub fn panels_for(names: &[&str], columns: &[Column]) -> Result<Vec<Panel>, PlotError> {
    let mut groups: Vec<((&str, Kind), Panel)> = Vec::new();
    for name in names {
        let column = find(name, columns)?;
        let kind = match column.kind {
            Kind::Discrete => Kind::Continuous,
            kind => kind,
        };
        let key = (column.unit.as_str(), kind);
        match groups.iter_mut().find(|(k, _)| *k == key) {
            Some((_, panel)) => panel.curves.push(column.name.clone()),
            None => {
                let label = scale::quantity(&column.unit).to_owned();
                groups.push((key, Panel { curves: vec![column.name.clone()], label }));
            }
        }
    }
    Ok(groups.into_iter().map(|(_, panel)| panel).collect())
}

/// The column called `name`.
pub fn find<'a>(name: &str, columns: &'a [Column]) -> Result<&'a Column, PlotError> {
    position(columns, name).map(|i| &columns[i]).ok_or_else(|| PlotError::UnknownCurve {
        name: name.to_owned(),
        near: did_you_mean(name, columns.iter().map(|c| c.name.as_str())).map(str::to_owned),
    })
}

fn suggestion(near: &Option<String>) -> String {
    near.as_ref().map_or(String::new(), |name| format!("; did you mean `{name}`?"))
}

fn unit(unit: &str) -> &str {
    if unit.is_empty() { "no unit" } else { unit }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns() -> Vec<Column> {
        let kind = |name: &str, kind| Column { kind, ..Column::new(name, "") };
        vec![
            Column::new("tank.p", "Pa"),
            Column::new("piston.s", "m"),
            Column::new("pipe[1,2].p", "Pa"),
            kind("closed", Kind::Boolean),
            kind("n", Kind::Integer),
            kind("ratio", Kind::Discrete),
        ]
    }

    #[test]
    fn one_panel_per_unit_in_order_of_appearance() {
        let names = ["tank.p", "n", "piston.s", "pipe[1, 2].p", "closed", "ratio"];
        let panels = panels_for(&names, &columns()).unwrap();
        let facts: Vec<(Vec<&str>, &str)> = panels
            .iter()
            .map(|p| (p.curves.iter().map(String::as_str).collect(), p.label.as_str()))
            .collect();
        assert_eq!(
            facts,
            [
                (vec!["tank.p", "pipe[1,2].p"], "pressure"),
                (vec!["n"], ""),
                (vec!["piston.s"], "length"),
                (vec!["closed"], ""),
                (vec!["ratio"], ""),
            ]
        );
    }

    #[test]
    fn an_unknown_name_gets_a_suggestion() {
        let error = panels_for(&["tank.q"], &columns()).unwrap_err().to_string();
        assert_eq!(error, "there is no variable `tank.q` in the result; did you mean `tank.p`?");
        let error = panels_for(&["velocity"], &columns()).unwrap_err().to_string();
        assert_eq!(error, "there is no variable `velocity` in the result");
    }
}
