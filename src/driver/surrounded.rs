//! An FMU as a model of equations that can be extended: sensors at its outputs, actuators at its inputs, parameters that
//! differ from run to run. Inside it nothing can be added.

use std::path::Path;
use std::sync::Arc;

use crate::base::index::FastMap;
use crate::fmu::import::model::{Fmu, Integrating, open_shared};
use crate::fmu::import::text::identifier;
use crate::fmu::import::whole::{Whole, model, start_name};
use crate::ir::foreign::{ForeignModel, ForeignRole, ForeignVariable};

use super::compile::{CompileError, Session};

/// Names of packages and models that a diagnosis adds.
const TAKEN: [&str; 3] = ["Effects", "Units", "Trial"];

/// An FMU that integrates itself, and the names of its variables. While it lives, models that run the FMU need not
/// unpack it.
#[derive(Debug)]
pub struct Surrounded {
    fmu: Arc<Fmu>,
    file: String,
}

/// What of the FMU the model has, besides its parameters, inputs and outputs; by the names in the FMU.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Wanted {
    /// The distance of communication points, s, if the FMU leaves it open.
    pub step: f64,
    /// Variables that it computes.
    pub shown: Vec<String>,
    /// Variables whose start values are parameters.
    pub starts: Vec<String>,
    /// Parameters that may change while it runs.
    pub passed: Vec<String>,
}

impl Surrounded {
    /// Reads an FMU; its code is not loaded. Errors go to the session.
    pub fn open(session: &mut Session, file: &Path) -> Result<Surrounded, CompileError> {
        let path = file.display().to_string();
        match open_shared(file, Integrating::RatherThere) {
            Ok(fmu) => Ok(Surrounded { fmu, file: path }),
            Err(diagnostic) => {
                session.problems.push(*diagnostic);
                Err(CompileError::Request)
            }
        }
    }

    /// The name of the model, an identifier: that of the file.
    pub fn class(&self) -> String {
        let stem = Path::new(&self.file).file_stem().unwrap_or_default().to_string_lossy();
        let letter = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
        let mut name: String = stem.chars().map(letter).collect();
        if !name.starts_with(|c: char| c.is_ascii_alphabetic()) || TAKEN.contains(&name.as_str()) {
            name.insert_str(0, "FMU_");
        }
        identifier(&name)
    }

    /// The name in the model of a variable of the FMU, and of a start value, `start(x)`; others as they are.
    pub fn name(&self, name: &str) -> String {
        let plain = name.trim();
        if let Some(variable) = plain.strip_prefix("start(").and_then(|v| v.strip_suffix(')')) {
            return identifier(&start_name(variable.trim()));
        }
        self.variable(plain).map_or_else(|| name.to_owned(), |v| identifier(&v.name))
    }

    fn variable(&self, name: &str) -> Option<&ForeignVariable> {
        self.fmu.interface().variables.iter().find(|v| v.name == name)
    }

    /// The parameters that keep their values while the FMU runs, by their names in the model.
    pub fn fixed_parameters(&self) -> Vec<String> {
        let all = &self.fmu.interface().variables;
        let fixed = all.iter().filter(|v| v.role == ForeignRole::Parameter && !v.is_tunable);
        fixed.map(|v| identifier(&v.name)).collect()
    }

    /// The text of the model.
    pub fn text(&self, wanted: &Wanted) -> String {
        let interface = self.fmu.interface();
        let own = interface.experiment[2].filter(|step| *step > 0.0 && !interface.steps_vary);
        let Wanted { step, shown, starts, passed } = wanted;
        let whole = Whole {
            class: &self.class(),
            file: &self.file,
            token: self.fmu.token(),
            step: own.unwrap_or(*step),
            is_even: own.is_some(),
            shown,
            starts,
            passed,
        };
        model(interface, &whole)
    }

    /// Settings `NAME=VALUE` with the names in the model.
    pub fn settings(&self, settings: &[String]) -> Vec<String> {
        let known: FastMap<&str, &ForeignVariable> =
            self.fmu.interface().variables.iter().map(|v| (v.name.as_str(), v)).collect();
        let renamed = |setting: &String| {
            let (name, value) = setting.split_once('=')?;
            let variable = known.get(name.trim())?;
            let attribute = if variable.role == ForeignRole::Input { ".start" } else { "" };
            Some(format!("{}{attribute}={value}", identifier(&variable.name)))
        };
        settings.iter().map(|s| renamed(s).unwrap_or_else(|| s.clone())).collect()
    }
}
