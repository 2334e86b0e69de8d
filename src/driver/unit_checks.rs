//! Units of a flat model, and of the values that a request gives to its parameters.

use super::compile::{Request, Session};
use super::quantity;

use crate::base::diag::{Diagnostic, Problems};
use crate::ir::flat::FlatModel;

/// Attributes of a variable that are in its unit.
const IN_UNIT_OF_VARIABLE: [&str; 4] = ["start", "min", "max", "nominal"];

impl Session {
    /// Warns of units that do not match in the sources that the user has named. Those of libraries
    /// are the business of `mocc check`.
    pub(super) fn compare_units(&mut self, flat: &mut FlatModel, request: &Request) {
        if !request.check_units {
            return;
        }
        let mut found = Problems::new();
        // The check adds nodes to the graph, and results must not depend on it.
        let nodes = flat.graph.len();
        crate::units::check(flat, &mut found);
        flat.graph.truncate(nodes);
        for d in found.iter() {
            let file = self.sources.get(d.primary.0.file).map(|f| f.path.as_path());
            let is_own = file.is_some_and(|path| {
                Some(path) == request.file.as_deref() || path.starts_with("--")
            });
            if is_own {
                self.problems.push(d.clone());
            }
        }
    }

    /// Refuses values whose units measure something else than their parameters. Returns the settings whose values in SI
    /// units are not those in the units of their parameters, with these.
    pub(super) fn compare_quantities(
        &mut self,
        flat: &FlatModel,
        quantities: &[(usize, quantity::Given)],
    ) -> Vec<(usize, String)> {
        let mut converted = Vec::new();
        for (at, given) in quantities {
            let named = |name: &str| flat.variables.iter().find(|v| v.name == name);
            // An attribute of these is in the unit of its variable.
            let of_attribute = || {
                let (variable, attribute) = given.name.rsplit_once('.')?;
                named(variable).filter(|_| IN_UNIT_OF_VARIABLE.contains(&attribute))
            };
            let Some(variable) = named(&given.name).or_else(of_attribute) else { continue };
            let value = given.quantity.in_unit(&variable.unit);
            if let Some(value) = value {
                if value != given.quantity.value {
                    converted.push((*at, format!("{}={value:?}", given.name)));
                }
            } else {
                let cause = quantity::QuantityCause::WrongUnit {
                    name: given.name.clone(),
                    declared: if variable.unit.is_empty() {
                        "1".into()
                    } else {
                        variable.unit.to_string()
                    },
                    unit: given.quantity.unit.clone(),
                };
                self.problems.push(Diagnostic::new(cause, variable.span));
            }
        }
        converted
    }
}
