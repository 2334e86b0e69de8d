//! Arguments of the commands at an operating point: `steady`, `linearize`.

use std::path::PathBuf;

use clap::Args;

use super::model::Model;
use super::values::{at, json, picture};

/// A model with constant inputs.
#[derive(Args, Debug)]
pub struct Point {
    /// The model.
    #[command(flatten)]
    pub model: Model,
    /// Hold an input at a value, SI or with a unit; repeatable [default: its start value].
    #[arg(long = "input", value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub inputs: Vec<String>,
    /// Relative tolerance of the simulation up to the point [default: annotation, else 1e-6].
    #[arg(long, value_name = "R", allow_negative_numbers = true)]
    pub tolerance: Option<f64>,
    /// Write the result as JSON; `-`, or nothing, prints it in place of the text.
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-", value_parser = json)]
    pub json: Option<PathBuf>,
    /// Print nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
}

/// A steady state.
#[derive(Args, Debug)]
pub struct Steady {
    /// The model and its inputs.
    #[command(flatten)]
    pub point: Point,
    /// Solve the equations from the initial values instead of simulating; also finds unstable states.
    #[arg(long)]
    pub solve: bool,
}

/// A linear system.
#[derive(Args, Debug)]
pub struct Linearize {
    /// The model and its inputs.
    #[command(flatten)]
    pub point: Point,
    /// Instant of a run, s, or `steady`.
    #[arg(long, value_name = "T|steady", default_value = "0", allow_negative_numbers = true, value_parser = at)]
    pub at: At,
    /// A variable that is an output; repeatable [default: the outputs of the model].
    #[arg(long = "output", value_name = "NAME")]
    pub outputs: Vec<String>,
    /// Draw magnitude and phase over frequency, .svg or .png; `-` prints them as SVG.
    #[arg(long, value_name = "PATH", visible_alias = "plot", value_parser = picture)]
    pub bode: Option<PathBuf>,
}

/// Where a model is linearized.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum At {
    /// At an instant of a run, s.
    Time(f64),
    /// Where it comes to rest.
    Steady,
}
