//! How a model is simulated.

use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};
use regex_lite::Regex;

use crate::fmu::import::model::Integrating;
use crate::ir::program::SystemForm;
use crate::simulate::settings::Method;

/// Simulation options.
#[derive(Args, Clone, Debug)]
pub struct Running {
    /// End of the simulation, s [default: experiment annotation, else 1].
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub stop: Option<f64>,
    /// Time between rows, s [default: annotation, else a 500th of the simulated time].
    #[arg(long, value_name = "DT", allow_negative_numbers = true)]
    pub interval: Option<f64>,
    /// Relative tolerance [default: annotation, else 1e-6].
    #[arg(long, value_name = "R", allow_negative_numbers = true)]
    pub tolerance: Option<f64>,
    /// Longest step, s: shorter pulses of the state may be stepped over [default: a 50th of the simulated time].
    #[arg(long, value_name = "DT", allow_negative_numbers = true)]
    pub max_step: Option<f64>,
    /// Integration method [default: that of mocc.toml, else auto].
    #[arg(long, value_name = "METHOD", value_enum)]
    pub method: Option<NamedMethod>,
    /// Solver of algebraic loops.
    #[arg(long, value_name = "MODE", value_enum, default_value_t = Mode::Reduced)]
    pub mode: Mode,
    /// Record only variables whose name matches this regular expression.
    #[arg(long, value_name = "REGEX", value_parser = Regex::new)]
    pub variables: Option<Regex>,
    /// Who integrates an FMU: mocc (Model Exchange) or the FMU (Co-Simulation) [default: me, if FILE offers it].
    #[arg(long, value_name = "TYPE", value_enum)]
    pub fmi_type: Option<ImportedType>,
}

/// Who integrates an imported FMU.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum ImportedType {
    /// Model Exchange.
    Me,
    /// Co-Simulation.
    Cs,
}

impl From<ImportedType> for Integrating {
    fn from(kind: ImportedType) -> Self {
        match kind {
            ImportedType::Me => Integrating::Here,
            ImportedType::Cs => Integrating::There,
        }
    }
}

/// An integration method by its name.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct NamedMethod(pub Method);

impl ValueEnum for NamedMethod {
    fn value_variants<'a>() -> &'a [Self] {
        const ALL: &[NamedMethod] = &[
            NamedMethod(Method::Auto),
            NamedMethod(Method::Radau),
            NamedMethod(Method::Bdf),
            NamedMethod(Method::Dopri),
        ];
        ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        let (name, help) = match self.0 {
            Method::Auto => ("auto", "Chosen by the structure of the model"),
            Method::Radau => {
                ("radau", "Radau IIA of order 5, implicit: stiff models, models with events")
            }
            Method::Bdf => (
                "bdf",
                "Backward differentiation of order 1 to 5, implicit: large stiff models without events",
            ),
            Method::Dopri => (
                "dopri",
                "Dormand and Prince's method of order 5, explicit: models that are not stiff",
            ),
        };
        Some(PossibleValue::new(name).help(help))
    }
}

/// Solver of algebraic loops.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum Mode {
    /// Solved inside each evaluation of the model.
    Reduced,
    /// Solved by the integrator together with the states: for large loops.
    Dae,
}

impl From<Mode> for SystemForm {
    fn from(mode: Mode) -> Self {
        match mode {
            Mode::Reduced => SystemForm::Ode,
            Mode::Dae => SystemForm::Dae,
        }
    }
}
