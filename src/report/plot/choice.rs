//! The figure of a run: the variables that the user names, or a default choice.

use super::figure::{PlotError, PlotSpec, find, panels_for};
use crate::ir::trajectory::{Kind, Trajectory};

/// Largest number of curves to draw by default.
const MAX_CURVES: usize = 8;

/// The figure of these variables, or of a default choice. `None` if nothing is named and nothing moves.
pub fn default_figure(
    title: &str,
    names: Option<&[String]>,
    trajectory: &Trajectory,
) -> Result<Option<PlotSpec>, PlotError> {
    let columns = &trajectory.columns;
    let chosen = match names {
        Some(names) => names.to_vec(),
        None => interesting(trajectory),
    };
    if chosen.is_empty() && names.is_none() {
        return Ok(None);
    }
    let chosen: Vec<&str> = chosen.iter().map(String::as_str).collect();
    let mut panels = panels_for(&chosen, columns)?;
    for panel in &mut panels {
        // A single curve in a panel is labelled by its description.
        if let [only] = panel.curves.as_slice() {
            let description = &find(only, columns)?.description;
            if !description.is_empty() {
                panel.label = description.trim().to_string();
            }
        }
    }
    Ok(Some(PlotSpec::new(title, panels)))
}

/// The default choice of curves: variables of the model itself, or else those of its components; only
/// positions and pressures if there are both.
pub fn interesting(trajectory: &Trajectory) -> Vec<String> {
    let real = |k: &Kind| *k == Kind::Continuous;
    let moving = |name: &str| trajectory.values(name).is_some_and(|v| v.iter().any(|x| *x != v[0]));
    let candidates = |top: bool| {
        trajectory
            .columns
            .iter()
            .filter(|c| real(&c.kind) && (!top || !c.name.contains('.')))
            .filter(|c| !c.name.starts_with("der(") && moving(&c.name))
            .collect::<Vec<_>>()
    };
    let mut chosen = candidates(true);
    if chosen.is_empty() {
        chosen = candidates(false);
    }
    let has = |unit: &str| chosen.iter().any(|c| c.unit == unit);
    if has("m") && has("Pa") {
        chosen.retain(|c| c.unit == "m" || c.unit == "Pa");
    }
    chosen.into_iter().take(MAX_CURVES).map(|c| c.name.clone()).collect()
}
