//! The parameters of a page, with their values in each run.

use super::runs::{FinishedRun, RunRequest};
use crate::base::index::{FastMap, FastSet};
use crate::base::source::Span;
use crate::report::page::parameters::{Parameter, Value};

/// Parameters in a page, in order of declaration.
const MOST_PARAMETERS: usize = 10_000;

/// The parameters whose names are `names`.
pub fn parameters(
    finished: &[FinishedRun],
    requested: &[RunRequest],
    names: &FastSet<String>,
    place: &dyn Fn(Span) -> String,
) -> Vec<Parameter> {
    let is_set = |run_request: &RunRequest, name: &str| {
        run_request.settings.iter().any(|s| {
            let target = s.split('=').next().unwrap_or_default().replace(' ', "");
            let rest = name.strip_prefix(target.as_str());
            rest.is_some_and(|r| r.is_empty() || r.starts_with(['[', '.']))
        })
    };
    let by_name: Vec<FastMap<&str, &Value>> = finished
        .iter()
        .map(|w| w.values.iter().map(|(c, v, _)| (c.name.as_str(), v)).collect())
        .collect();
    let mut out = Vec::new();
    let own = finished[0].values.iter().filter(|(c, ..)| names.contains(&c.name));
    for (column, _, span) in own.take(MOST_PARAMETERS) {
        let of = |values: &FastMap<&str, &Value>| match values.get(column.name.as_str()) {
            Some(value) => (*value).clone(),
            None => Value::Text(String::new()),
        };
        out.push(Parameter {
            name: column.name.clone(),
            values: by_name.iter().map(of).collect(),
            unit: column.unit.clone(),
            display_unit: column.display_unit.clone(),
            description: column.description.clone(),
            place: place(*span),
            set: requested.iter().map(|a| is_set(a, &column.name)).collect(),
        });
    }
    out
}
