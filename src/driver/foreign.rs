//! FMUs in the place of models: the compiler reads a model with the same variables, and the program gets the FMU that
//! computes them.

use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;

use crate::base::diag::Diagnostic;
use crate::base::index::FastMap;
use crate::base::name::split_unquoted;
use crate::base::source::Span;
use crate::fmu::cause::FmuCause;
use crate::fmu::import::{model, text};
use crate::ir::expr::Type;
use crate::ir::flat::{Causality, FlatModel, Variability};
use crate::ir::foreign::{Foreign, ForeignModel, ForeignRole, ForeignVariable};
use crate::ir::program::Program;

use super::compile::{CompileError, Request, Session};

/// True for the path of an FMU.
pub fn is_fmu(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("fmu"))
}

impl Session {
    /// The request with the text of the model that stands for its FMU, if it names one.
    pub(super) fn with_foreign<'r>(
        &mut self,
        request: &'r Request,
    ) -> Result<Cow<'r, Request>, CompileError> {
        let Some(file) = request.file.as_deref().filter(|f| is_fmu(f)) else {
            return Ok(Cow::Borrowed(request));
        };
        if !request.takes_fmu {
            self.problems
                .push(needs_equations(file, "this command needs the equations of a model"));
            return Err(CompileError::Request);
        }
        let path = file.display().to_string();
        let foreign = match self.foreign.clone().filter(|f| f.file() == path) {
            Some(foreign) => foreign,
            None => match model::open(file, request.integrating) {
                Ok(fmu) => Arc::new(fmu) as Arc<dyn ForeignModel>,
                Err(diagnostic) => {
                    self.problems.push(*diagnostic);
                    return Err(CompileError::Request);
                }
            },
        };
        let interface = foreign.interface();
        let mut request = request.clone();
        request.text = Some(text::model(interface));
        let names: FastMap<String, &ForeignVariable> =
            interface.variables.iter().map(|v| (plain(&v.name), v)).collect();
        for setting in &mut request.settings {
            let Some((name, value)) = split_unquoted(setting, '=') else { continue };
            let (name, attribute) = match plain(name) {
                name if names.contains_key(&name) => (name, ""),
                name => match name.strip_suffix(".start") {
                    Some(variable) => (variable.to_owned(), ".start"),
                    None => (name, ""),
                },
            };
            let Some(variable) = names.get(&name) else { continue };
            // Without a recording an input keeps the value that it starts with.
            let is_input = variable.role == ForeignRole::Input;
            let attribute = if is_input { ".start" } else { attribute };
            *setting = format!("{}{attribute}={value}", text::identifier(&variable.name));
        }
        self.foreign = Some(foreign);
        Ok(Cow::Owned(request))
    }

    /// Gives the variables their names in the FMU, and marks those that it computes.
    pub(super) fn adopt_names(&mut self, flat: &mut FlatModel) {
        let Some(foreign) = &self.foreign else { return };
        let interface = foreign.interface();
        if flat.name == text::identifier(&interface.name) {
            flat.name.clone_from(&interface.name);
        }
        let quoted = interface.variables.iter().map(|v| (text::identifier(&v.name), &v.name));
        let names: FastMap<String, &String> =
            quoted.filter(|(identifier, name)| identifier != *name).collect();
        for k in flat.variables.ids() {
            if let Some(name) = names.get(&flat.variables[k].name) {
                flat.variables[k].name = (*name).clone();
            }
        }
    }

    /// Marks the variables that the FMU computes as signals.
    pub(super) fn drive_computed(&self, flat: &mut FlatModel) {
        if self.foreign.is_none() {
            return;
        }
        for k in flat.variables.ids() {
            let v = &flat.variables[k];
            let is_open = v.ty == Type::Real
                && v.variability == Variability::Continuous
                && v.causality == Some(Causality::Input)
                && v.binding.is_none();
            if is_open && !flat.recorded.contains(&k) {
                flat.recorded.push(k);
            }
        }
    }

    /// Gives the program its FMU.
    pub(super) fn attach_foreign(&mut self, program: &mut Program) {
        let Some(model) = &self.foreign else { return };
        let variables = &program.blocks.dae.variables;
        let known: FastMap<&str, _> =
            variables.enumerate().map(|(id, v)| (v.name.as_str(), id)).collect();
        let own = model.interface().variables.iter().enumerate();
        let found = own.filter_map(|(k, v)| Some((*known.get(v.name.as_str())?, k)));
        program.foreign =
            Some(Arc::new(Foreign { variables: found.collect(), model: Arc::clone(model) }));
    }
}

/// A name without spaces.
fn plain(name: &str) -> String {
    name.chars().filter(|c| !c.is_whitespace()).collect()
}

/// The refusal of an FMU that a file names and the command does not.
pub fn not_allowed(file: &Path) -> Diagnostic {
    Diagnostic::new(FmuCause::NotAllowed { path: file.display().to_string() }, Span::NONE)
}

/// The refusal of a command that cannot do with an FMU.
pub fn needs_equations(file: &Path, what: &str) -> Diagnostic {
    let cause =
        FmuCause::NeedsEquations { path: file.display().to_string(), what: what.to_owned() };
    Diagnostic::new(cause, Span::NONE)
}
