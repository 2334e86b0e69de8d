//! Arguments of the commands with results of runs: `compare`, `plot`.

use std::path::PathBuf;

use clap::Args;

use super::values::{ends, picture, tolerance, unit_of};
use crate::compare::tolerance::ABSOLUTE;

/// Two results.
#[derive(Args, Debug)]
pub struct Compare {
    /// Result of a run, in one of the formats of results; `-` reads CSV from standard input.
    #[arg(value_name = "FILE")]
    pub found: PathBuf,
    /// Result that it is compared with, likewise.
    #[arg(value_name = "REFERENCE")]
    pub reference: PathBuf,
    /// Variables to compare, separated by commas; `*` means any characters [default: those that both have].
    #[arg(long, value_name = "NAME,...")]
    pub show: Option<String>,
    /// A variable that has another name in the reference; repeatable.
    #[arg(long = "name", value_name = "NAME=OTHER")]
    pub names: Vec<String>,
    /// Tolerance relative to the extent of each variable.
    #[arg(long, allow_negative_numbers = true, value_name = "R", default_value_t = 1e-3, value_parser = tolerance)]
    pub relative: f64,
    /// Tolerance that is added to it, in the unit of the variables.
    #[arg(long, allow_negative_numbers = true, value_name = "A", default_value_t = ABSOLUTE, value_parser = tolerance)]
    pub absolute: f64,
    /// Time by which changes may come earlier or later, s [default: a 10000th of the reference's].
    #[arg(long, allow_negative_numbers = true, value_name = "T", value_parser = tolerance)]
    pub time: Option<f64>,
    /// Draw the variables that differ most, .svg or .png; `-` prints them as SVG in place of the text.
    #[arg(long, value_name = "PATH", value_parser = picture)]
    pub plot: Option<PathBuf>,
    /// Print the differences as JSON on standard output.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
}

/// A chart.
#[derive(Args, Debug)]
pub struct Plot {
    /// Tables, .csv, .parquet or .mat, each with an optional label; `-` is CSV on the standard input.
    #[arg(value_name = "FILE[=LABEL]", required = true)]
    pub tables: Vec<String>,
    /// Second group of tables, drawn next to the first on the same axes.
    #[arg(long, value_name = "FILE[=LABEL]", num_args = 1..)]
    pub beside: Vec<String>,
    /// Horizontal axis: a column, or a label and a formula over columns; mocc uses the first formula whose columns exist
    /// [default: the first column].
    #[arg(long, value_name = "LABEL: FORMULA[|...]", allow_hyphen_values = true)]
    pub x: Option<String>,
    /// Vertical axis of a panel: a column, or its label and formula; repeat for more panels [default: the first columns].
    #[arg(long, value_name = "LABEL: FORMULA[|...]", allow_hyphen_values = true)]
    pub y: Vec<String>,
    /// Draw a curve for each value of this column.
    #[arg(long, value_name = "COLUMN")]
    pub by: Option<String>,
    /// Draw a column in another unit, such as p2=bar; repeatable [default: the unit in the file].
    #[arg(long = "unit", value_name = "NAME=UNIT", value_parser = unit_of)]
    pub units: Vec<(String, String)>,
    /// Draw only this part of the horizontal axis.
    #[arg(long, value_name = "FROM:TO", allow_hyphen_values = true, value_parser = ends)]
    pub range: Option<(f64, f64)>,
    /// Use a logarithmic horizontal axis.
    #[arg(long)]
    pub log_x: bool,
    /// Title of the picture.
    #[arg(long, value_name = "TEXT")]
    pub title: Option<String>,
    /// Heading of the first group of tables; repeat for the second.
    #[arg(long = "heading", value_name = "TEXT")]
    pub headings: Vec<String>,
    /// Picture, .svg or .png; `-` prints it as SVG [default: the first FILE with .svg].
    #[arg(short, long, value_name = "PATH", value_parser = picture)]
    pub output: Option<PathBuf>,
    /// Print nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
}
